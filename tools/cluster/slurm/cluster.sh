#!/usr/bin/env bash
# A Slurm cluster of two nodes on this one machine, for tests of what is submitted to Slurm. Real daemons, loopback
# only, as root or as an ordinary user; every file lies below FOLDER, nothing below /etc is read or written.
#
#   cluster.sh start FOLDER         starts what does not run; a fresh start forgets earlier jobs
#   cluster.sh stop FOLDER          ends all daemons and the jobs that run
#   cluster.sh status FOLDER        the nodes and the daemons; exit code 1 unless all of them run
#   cluster.sh kill-node FOLDER N   kills node 1 or 2 with its jobs, as a power cut would
#   cluster.sh start-node FOLDER N  starts it again
#
# `. FOLDER/env.sh` lets sbatch, squeue, scancel and scontrol find the cluster. Exit code 77: Slurm is not installed.
set -euo pipefail
PATH=$PATH:/usr/sbin:/sbin

nodes=(1 2)
start_limit=60 # seconds until a start counts as failed; 0.5 are usual

die() {
  echo "cluster.sh: $1" >&2
  exit "${2:-1}"
}

usage() {
  sed -n '5,9s/^# *//p' "$0" >&2
  exit 2
}

# Whether a process number is a daemon of this cluster: after a crash it may be another's, and a zombie has no arguments.
alive() {
  [[ $1 =~ ^[0-9]+$ ]] && { tr '\0' ' ' <"/proc/$1/cmdline" | grep -qF -- "$folder/"; } 2>/dev/null
}

# Prints the process of the named daemon if it runs.
running() {
  local pid_file=$folder/run/$1.pid pid
  [[ -s $pid_file ]] && pid=$(<"$pid_file") && alive "$pid" && echo "$pid"
}

# Sends a signal to processes that may have gone by now.
signal() {
  local name=$1
  shift
  (($# == 0)) || kill -s "$name" "$@" 2>/dev/null || true
}

# Ends one daemon: politely, after three seconds by force.
end_daemon() {
  local pid tries
  pid=$(running "$1") || return 0
  signal TERM "$pid"
  for ((tries = 0; tries < 60; ++tries)); do
    alive "$pid" || return 0
    sleep 0.05
  done
  signal KILL "$pid"
}

# Fills `steps` with a node's step managers and `tasks` with what they started. A step manager keeps the working folder
# of its slurmd, which no other cluster shares; a task that left its parent still has the node's name in its environment.
find_steps() {
  local node=$1 dir pid parent environment more=1
  local -A parents=() found=()
  steps=() tasks=()
  for dir in /proc/[0-9]*; do
    pid=${dir#/proc/}
    { read -r _ parent < <(sed -n 's/^PPid:/PPid /p' "$dir/status"); } 2>/dev/null || continue
    parents[$pid]=$parent
    if [[ $(readlink "$dir/exe" 2>/dev/null) == */slurmstepd* &&
      $(readlink "$dir/cwd" 2>/dev/null) == "$folder/node$node" ]]; then
      steps+=("$pid") found[$pid]=1
      continue
    fi
    environment=$(tr '\0' '\n' 2>/dev/null <"$dir/environ") || continue
    if [[ $'\n'$environment$'\n' == *$'\n'"SLURM_CONF=$folder/slurm.conf"$'\n'* &&
      $'\n'$environment$'\n' == *$'\n'"SLURMD_NODENAME=node$node"$'\n'* ]]; then
      tasks+=("$pid") found[$pid]=1
    fi
  done
  while ((more)); do
    more=0
    for pid in "${!parents[@]}"; do
      [[ -z ${found[$pid]:-} && -n ${found[${parents[$pid]}]:-} ]] || continue
      tasks+=("$pid") found[$pid]=1 more=1
    done
  done
}

# Kills a node's jobs, the step managers first so that none of them can report how its tasks ended.
kill_steps() {
  find_steps "$1"
  signal KILL "${steps[@]}"
  signal KILL "${tasks[@]}"
}

# Chooses a port that nothing answers on, below those that the system hands out by itself.
free_port() {
  local port
  while :; do
    port=$((20000 + RANDOM % 12000))
    [[ " ${ports[*]} " != *" $port "* ]] && ! (: <"/dev/tcp/127.0.0.1/$port") 2>/dev/null && break
  done
  ports+=("$port")
}

# Sets the host's name and the command that starts a daemon under it. A daemon listens on the address of its host's name;
# where that is not 127.0.0.1, the daemons get a name space with the name localhost.
choose_host() {
  local address
  host=$(uname -n) launch=(env)
  read -r address _ < <(getent ahostsv4 "$host") || true
  if [[ ${address:-} != 127.0.0.1 ]]; then
    host=localhost launch=(unshare --uts)
    (($(id -u) == 0)) || launch+=(--user --map-current-user --keep-caps)
    # shellcheck disable=SC2016
    launch+=(sh -c 'hostname localhost && exec "$@"' sh)
    "${launch[@]}" true || die "the host's name must mean 127.0.0.1 in /etc/hosts, as 'unshare --uts' does not work"
  fi
  host=${host%%.*}
}

write_configuration() {
  local user cpus memory node
  ports=()
  free_port && free_port && free_port
  user=$(id -un)
  cpus=$(nproc) && ((cpus >= 2)) || cpus=2
  memory=$(($(sed -n 's/^MemTotal: *\([0-9]*\).*/\1/p' /proc/meminfo) / 1024))
  rm -rf "${folder:?}"/{run,state,node1,node2,log}
  mkdir -p "$folder"/{run,state,node1,node2,log}
  chmod 700 "$folder"/{state,node1,node2,log}
  chmod 755 "$folder"/run
  (umask 077 && head -c 1024 /dev/urandom >"$folder/run/munge.key")
  {
    cat <<END
# Written by cluster.sh.
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmUser=$user
SlurmdUser=$user
# Loopback alone.
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
MailProg=/bin/true
AuthType=auth/munge
CredType=cred/munge
# A job that is put back into the queue rests for cred_expire seconds (120 unless set).
AuthInfo=socket=$folder/run/munge.socket,cred_expire=5
StateSaveLocation=$folder/state
SlurmctldPidFile=$folder/run/slurmctld.pid
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdSpoolDir=$folder/%n
SlurmdPidFile=$folder/run/slurmd-%n.pid
SlurmdLogFile=$folder/%n/slurmd.log
# Neither control groups nor kernel modules.
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SwitchType=switch/none
MpiDefault=none
# One line for each job that ended, as there is no accounting.
JobCompType=jobcomp/filetxt
JobCompLoc=$folder/log/ended_jobs.txt
# Several tasks at a time on a node, which counts as large as written here.
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
# A node that dies is noticed soon, its jobs go back into the queue, and it may come back.
SlurmdTimeout=10
ReturnToService=2
JobRequeue=1
KillWait=3
# Jobs start at once and can be asked about for an hour after their end.
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=5,bf_interval=1
MinJobAge=3600
MaxArraySize=10001
MaxJobCount=100000
END
    for node in "${nodes[@]}"; do
      echo "NodeName=node$node NodeHostname=$host NodeAddr=127.0.0.1 Port=${ports[node]}" \
        "Sockets=$cpus CoresPerSocket=1 ThreadsPerCore=1 RealMemory=$memory State=UNKNOWN"
    done
    echo "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP"
  } >"$folder/slurm.conf"
  # slurmd loads a control group plugin even if nothing uses one; that of version 1 loads everywhere.
  echo "CgroupPlugin=cgroup/v1" >"$folder/cgroup.conf"
  echo "export SLURM_CONF='$folder/slurm.conf'" >"$folder/env.sh"
}

start_munged() {
  running munged >/dev/null && return
  rm -f "$folder"/run/munge.socket*
  # --force: a folder above that others cannot enter is only worth a warning.
  munged --force --num-threads=2 --key-file="$folder/run/munge.key" --socket="$folder/run/munge.socket" \
    --pid-file="$folder/run/munged.pid" --seed-file="$folder/run/munge.seed" \
    --log-file="$folder/log/munged.log" </dev/null >"$folder/log/munged.out" 2>&1 ||
    die "munged did not start: $(tail -n 1 "$folder/log/munged.out")"
}

start_controller() {
  running slurmctld >/dev/null && return
  (cd "$folder/state" && "${launch[@]}" slurmctld -f "$folder/slurm.conf" "$@" </dev/null >"$folder/log/slurmctld.out" 2>&1) ||
    die "slurmctld did not start: $(tail -n 1 "$folder/log/slurmctld.out")"
}

start_node() {
  running "slurmd-node$1" >/dev/null && return
  # -s: the daemon's working folder becomes that of its log, by which find_steps knows what it started.
  (cd "$folder/node$1" &&
    "${launch[@]}" slurmd -s -N "node$1" -f "$folder/slurm.conf" </dev/null >"$folder/log/node$1.out" 2>&1) ||
    die "node$1 did not start: $(tail -n 1 "$folder/log/node$1.out")"
}

# Prints the names of the nodes that take jobs.
ready_nodes() {
  SLURM_CONF=$folder/slurm.conf timeout 5 sinfo -h -N -o '%N %T' 2>/dev/null |
    sed -nE 's/^(\S+) (idle|mixed|allocated|completing)$/\1/p' | sort -u
}

wait_ready() {
  local begin=$SECONDS name
  for name; do
    until ready_nodes | grep -qx "$name"; do
      ((SECONDS - begin < start_limit)) || die "$name is not ready after $start_limit s; see $folder/log, $folder/$name"
      sleep 0.1
    done
  done
}

start() {
  local begin=${EPOCHREALTIME//[!0-9]/} command missing=() node any=
  for command in slurmctld slurmd sbatch munged; do
    command -v "$command" >/dev/null || missing+=("$command")
  done
  ((${#missing[@]} == 0)) ||
    die "no ${missing[*]}: install the packages slurmctld slurmd slurm-client munge (Debian's names)" 77
  choose_host
  for command in munged slurmctld "${nodes[@]/#/slurmd-node}"; do
    running "$command" >/dev/null && any=1
  done
  if [[ -z $any ]]; then
    for node in "${nodes[@]}"; do kill_steps "$node"; done # what a crash left
    write_configuration
    start_munged
    start_controller -c
  else
    start_munged
    start_controller
  fi
  for node in "${nodes[@]}"; do start_node "$node"; done
  wait_ready "${nodes[@]/#/node}"
  printf 'up after %d.%02d s\n' $(((${EPOCHREALTIME//[!0-9]/} - begin) / 1000000)) \
    $(((${EPOCHREALTIME//[!0-9]/} - begin) / 10000 % 100))
}

# The controller goes first: it shall not start on one node what ends on the other.
stop() {
  local node
  end_daemon slurmctld
  for node in "${nodes[@]}"; do
    end_daemon "slurmd-node$node"
    kill_steps "$node"
  done
  end_daemon munged
}

status() {
  local name pid all=0
  for name in munged slurmctld "${nodes[@]/#/slurmd-node}"; do
    if pid=$(running "$name"); then
      echo "$name: process $pid, $(sed -n 's/^VmRSS:\s*//p' "/proc/$pid/status")"
    else
      echo "$name: not running"
      all=1
    fi
  done
  if running slurmctld >/dev/null; then
    SLURM_CONF=$folder/slurm.conf timeout 10 sinfo -h -N -o '%N: %T, %C CPUs (allocated/idle/other/total)' || all=1
  fi
  return "$all"
}

kill_node() {
  local pid
  if pid=$(running "slurmd-node$1"); then
    signal KILL "$pid"
  fi
  kill_steps "$1"
}

(($# >= 2)) || usage
action=$1
[[ $action == start ]] && mkdir -p "$2"
[[ -d $2 ]] || die "no folder $2"
folder=$(cd "$2" && pwd -P)
[[ $folder =~ ^[A-Za-z0-9_./+-]+$ ]] || die "the folder's path may hold letters, digits and _ . / + - only: $folder"
# A socket's path has at most 107 bytes; the longest one here is that of a step below the node's folder.
((${#folder} <= 75)) || die "the folder's path is longer than 75 bytes: $folder"

case $action in
  start | stop | status)
    (($# == 2)) || usage
    "$action"
    ;;
  kill-node | start-node)
    [[ $# == 3 && $3 =~ ^[12]$ ]] || usage
    [[ -s $folder/slurm.conf ]] || die "no cluster in $folder"
    if [[ $action == kill-node ]]; then
      kill_node "$3"
    else
      choose_host
      start_node "$3"
      wait_ready "node$3"
    fi
    ;;
  *) usage ;;
esac
