#!/usr/bin/env bash
# A small Hadoop of real daemons on this machine, to test what runs on a big one: HDFS with two data nodes, YARN with
# two node managers that start real containers, and the MapReduce job history. Each daemon is a JVM of its own and
# listens on 127.0.0.1 only.
#
#   cluster.sh start FOLDER          fetches the jars if need be, starts what does not run yet, waits until jobs can run
#   cluster.sh stop FOLDER           ends all daemons and containers; HDFS keeps its files for the next start
#   cluster.sh status FOLDER         which daemons run; exit code 1 if some do not
#   cluster.sh kill-node FOLDER N    kills node manager N (1 or 2) and its containers without warning
#   cluster.sh start-node FOLDER N   starts it again
#
# FOLDER holds everything: jars (lib/, or $VESALIUS_HADOOP_LIB), HDFS (hdfs/), logs (log/), and for the caller env.sh to
# source and bin/ with `mapred`, `hdfs` and `yarn`, used like Hadoop's own commands. Any user of this machine can reach
# the cluster and act as any HDFS user: it is for tests.
#
# Exit code 77: cannot run here (the reason is on stderr); 1: failed; 2: wrong usage.
# shellcheck disable=SC2154 # $port_... come from FOLDER/ports
set -euo pipefail

readonly kDaemons=(namenode datanode1 datanode2 resourcemanager nodemanager1 nodemanager2 historyserver)
readonly kSecondsToStart=180

usage() {
  sed -n '/^#   cluster.sh/s/^#   //p' "$0" >&2
  exit 2
}

fail() {
  echo "cluster.sh: $*" >&2
  exit 1
}

skip() {
  echo "cluster.sh: skipped: $*" >&2
  exit 77
}

# --- what the machine has ---------------------------------------------------------------------------------------------

find_java() {
  if [[ -z ${JAVA_HOME:-} || ! -x $JAVA_HOME/bin/java ]]; then
    local java
    java=$(command -v java) || skip "no java"
    java=$(readlink -f "$java")
    JAVA_HOME=${java%/bin/java}
  fi
  export JAVA_HOME
  command -v curl > /dev/null || skip "no curl"
  local version
  version=$("$JAVA_HOME/bin/java" -version 2>&1 | sed -n 's/.*version "\([0-9]*\).*/\1/p')
  # Java 8 lacks --add-opens; from 23 on, Java refuses the security calls that Hadoop 3.4 makes.
  [[ -n $version && $version -ge 11 && $version -le 22 ]] || skip "needs Java 11 to 22, $JAVA_HOME is ${version:-unknown}"
}

fetch_jars() {
  local pom marker
  pom=$(dirname "$(readlink -f "$0")")/pom.xml
  marker=$lib/complete-$(cksum < "$pom" | tr ' ' '-')  # another pom.xml is another set of jars
  [[ -e $marker ]] && return
  command -v mvn > /dev/null || skip "no mvn to fetch Hadoop's jars"
  echo "fetching Hadoop's jars"
  rm -rf "$lib/fetching"  # jars of an older pom.xml must not stay beside the new ones
  mkdir -p "$lib/fetching"
  if ! JAVA_HOME=$JAVA_HOME mvn -q -B -f "$pom" dependency:copy-dependencies -DincludeScope=runtime \
      -DoutputDirectory="$lib/fetching" > "$folder/log/fetch.log" 2>&1; then
    skip "cannot fetch Hadoop's jars: $(grep -m 1 ERROR "$folder/log/fetch.log" | cut -c 1-300)"
  fi
  rm -f "$lib"/*.jar "$lib"/complete-*
  mv "$lib/fetching"/*.jar "$lib"
  rmdir "$lib/fetching"
  touch "$marker"
}

# Servers inside Hadoop that no setting binds to an address (the shuffle, an application master's three) ask for all of
# the machine's addresses. A library that the JVMs preload gives them the loopback address.
build_loopback_library() {
  local source
  source=$(dirname "$(readlink -f "$0")")/loopback_only.c
  preload=$folder/loopback_only.so
  [[ $preload -nt $source ]] && return
  local cc
  cc=$(command -v cc || command -v gcc || command -v clang) || skip "no C compiler for loopback_only.c"
  "$cc" -O2 -shared -fPIC -o "$preload" "$source" -ldl || fail "loopback_only.c does not build"
}

# A port below those that the system hands out (from 32768 by default), that nobody listens on and that was not chosen
# before.
chosen_ports=" "
free_port() {  # sets $port
  local i
  for ((i = 0; i < 1000; ++i)); do
    port=$((20000 + (RANDOM * 32768 + RANDOM) % 12000))
    [[ $chosen_ports == *" $port "* ]] && continue
    (exec 3<> "/dev/tcp/127.0.0.1/$port") 2> /dev/null && continue
    chosen_ports+="$port "
    return
  done
  fail "no free port"
}

# --- processes --------------------------------------------------------------------------------------------------------

# There are no pid files to go stale: each daemon's command line says whose it is. Several lines if several run.
pids_of() {  # DAEMON
  # shellcheck disable=SC2062
  grep -lzxF --regexp="-Dvesalius.daemon=$folder:$1" /proc/[0-9]*/cmdline 2> /dev/null | cut -d / -f 3 || true
}

runs() {  # DAEMON
  [[ -n $(pids_of "$1") ]]
}

# YARN tells each container, and it its children, its folders.
containers_of() {  # N
  grep -lz "^LOCAL_DIRS=${folder//./\\.}/node$1/local/" /proc/[0-9]*/environ 2> /dev/null | cut -d / -f 3 || true
}

kill_containers_of() {  # N; its node manager must be gone
  local i pids
  for ((i = 0; i < 50; ++i)); do
    pids=$(containers_of "$1")
    [[ -z $pids ]] && return
    # shellcheck disable=SC2086
    kill -9 $pids 2> /dev/null || true
    sleep 0.1
  done
  fail "containers of node $1 do not end: $pids"
}

# --- configuration ----------------------------------------------------------------------------------------------------

# Turns lines `name value` into Hadoop's XML; empty lines and lines that start with # are left out.
write_site() {  # FILE
  {
    echo '<configuration>'
    sed -n 's|^\([a-z][^ ]*\) *\(.*\)$|<property><name>\1</name><value>\2</value></property>|p'
    echo '</configuration>'
  } > "$1"
}

choose_ports() {
  local name
  for name in namenode namenode_http resourcemanager scheduler tracker rm_admin rm_http history history_http history_admin \
      node1 node1_localizer node1_http node2 node2_localizer node2_http; do
    free_port
    echo "port_$name=$port"
  done > "$folder/ports"
}

write_configuration() {
  # shellcheck source=/dev/null
  source "$folder/ports"
  local conf=$folder/conf host=127.0.0.1
  local jvm="-XX:+UseSerialGC -XX:TieredStopAtLevel=1 -Djava.net.preferIPv4Stack=true $opens"
  mkdir -p "$conf"

  write_site "$conf/core-site.xml" << EOF
fs.defaultFS hdfs://$host:$port_namenode
hadoop.tmp.dir $folder/tmp
EOF

  write_site "$conf/hdfs-site.xml" << EOF
dfs.namenode.http-address $host:$port_namenode_http
dfs.namenode.name.dir file://$folder/hdfs/name
dfs.namenode.datanode.registration.ip-hostname-check false
dfs.namenode.safemode.extension 0
dfs.namenode.handler.count 4

dfs.replication 2
dfs.permissions.enabled true
dfs.webhdfs.enabled true
# A data node that dies is missed after 2 recheck intervals and 10 heartbeats: 20 s.
dfs.heartbeat.interval 1
dfs.namenode.heartbeat.recheck-interval 5000
# With two data nodes there is no third to write on with when one dies.
dfs.client.block.write.replace-datanode-on-failure.policy NEVER

# The ports are the system's to choose: data nodes tell theirs to the name node.
dfs.datanode.hostname $host
dfs.datanode.address $host:0
dfs.datanode.http.address $host:0
dfs.datanode.ipc.address $host:0
dfs.datanode.data.dir file://$folder/hdfs/\${vesalius.name}
EOF

  write_site "$conf/yarn-site.xml" << EOF
yarn.resourcemanager.hostname $host
yarn.resourcemanager.address $host:$port_resourcemanager
yarn.resourcemanager.scheduler.address $host:$port_scheduler
yarn.resourcemanager.resource-tracker.address $host:$port_tracker
yarn.resourcemanager.admin.address $host:$port_rm_admin
yarn.resourcemanager.webapp.address $host:$port_rm_http
yarn.resourcemanager.connect.retry-interval.ms 1000
yarn.resourcemanager.nodemanagers.heartbeat-interval-ms 100
yarn.resourcemanager.scheduler.class org.apache.hadoop.yarn.server.resourcemanager.scheduler.capacity.CapacityScheduler
yarn.scheduler.minimum-allocation-mb 128
# A node that is silent for 10 s is lost, and what ran there runs again elsewhere.
yarn.nm.liveness-monitor.expiry-interval-ms 10000
yarn.am.liveness-monitor.expiry-interval-ms 30000
yarn.client.nodemanager-connect.retry-interval-ms 1000
yarn.client.nodemanager-connect.max-wait-ms 5000

# Each node manager is started with its own values of these (java -Dvesalius...=).
yarn.nodemanager.hostname $host
yarn.nodemanager.address $host:\${vesalius.port}
yarn.nodemanager.localizer.address $host:\${vesalius.localizer}
yarn.nodemanager.webapp.address $host:\${vesalius.http}
yarn.nodemanager.local-dirs $folder/\${vesalius.name}/local
yarn.nodemanager.log-dirs $folder/\${vesalius.name}/log
yarn.nodemanager.aux-services mapreduce_shuffle
yarn.nodemanager.container-executor.class org.apache.hadoop.yarn.server.nodemanager.DefaultContainerExecutor
yarn.nodemanager.env-whitelist JAVA_HOME
yarn.nodemanager.resource.memory-mb 3072
yarn.nodemanager.resource.cpu-vcores 2
yarn.nodemanager.pmem-check-enabled false
yarn.nodemanager.vmem-check-enabled false
yarn.nodemanager.disk-health-checker.enable false
# It looks once all the same, and by default a disk that is nine tenths full has no room for a job.
yarn.nodemanager.disk-health-checker.max-disk-utilization-per-disk-percentage 100

yarn.application.classpath $lib/*
# As on most clusters: tasks' logs move to HDFS when their job is over, for \`yarn logs\`.
yarn.log-aggregation-enable true
yarn.log.server.url http://$host:$port_history_http/jobhistory/logs
EOF

  write_site "$conf/capacity-scheduler.xml" << EOF
yarn.scheduler.capacity.root.queues default
yarn.scheduler.capacity.root.default.capacity 100
yarn.scheduler.capacity.maximum-am-resource-percent 0.5
yarn.scheduler.capacity.node-locality-delay -1
# Cores count, not only memory.
yarn.scheduler.capacity.resource-calculator org.apache.hadoop.yarn.util.resource.DominantResourceCalculator
EOF

  write_site "$conf/mapred-site.xml" << EOF
mapreduce.framework.name yarn
mapreduce.application.classpath $lib/*
mapreduce.shuffle.port 0
mapreduce.jobhistory.address $host:$port_history
mapreduce.jobhistory.webapp.address $host:$port_history_http
mapreduce.jobhistory.admin.address $host:$port_history_admin

yarn.app.mapreduce.am.resource.mb 384
yarn.app.mapreduce.am.command-opts -Xmx200m $jvm
yarn.app.mapreduce.am.env LD_PRELOAD=$preload
mapreduce.map.memory.mb 512
mapreduce.map.java.opts -Xmx200m $jvm
mapreduce.reduce.memory.mb 512
mapreduce.reduce.java.opts -Xmx200m $jvm
mapreduce.task.io.sort.mb 64

# Jobs of seconds: ask often, run every task in a container, and let no reduction hold a core that maps need.
mapreduce.job.ubertask.enable false
mapreduce.job.reduce.slowstart.completedmaps 1.0
yarn.app.mapreduce.am.scheduler.heartbeat.interval-ms 100
mapreduce.client.progressmonitor.pollinterval 200
mapreduce.client.completion.pollinterval 200
mapreduce.jobhistory.move.interval-ms 1000
EOF

  # Commands log to stderr as Hadoop's own do; daemons to a file of their own.
  cat > "$conf/log4j.properties" << 'EOF'
log4j.rootLogger=${vesalius.log}
log4j.appender.console=org.apache.log4j.ConsoleAppender
log4j.appender.console.target=System.err
log4j.appender.console.layout=org.apache.log4j.PatternLayout
log4j.appender.console.layout.ConversionPattern=%d{ISO8601} %p %c{2}: %m%n
log4j.appender.file=org.apache.log4j.RollingFileAppender
log4j.appender.file.File=${vesalius.logfile}
log4j.appender.file.MaxFileSize=20MB
log4j.appender.file.MaxBackupIndex=1
log4j.appender.file.layout=org.apache.log4j.PatternLayout
log4j.appender.file.layout.ConversionPattern=%d{ISO8601} %p %c{2}: %m%n
log4j.logger.org.apache.hadoop.util.NativeCodeLoader=ERROR
EOF
}

# --- commands for the caller ------------------------------------------------------------------------------------------

write_command() {  # NAME, then SUBCOMMAND=CLASS...
  local name=$1 pair
  shift
  {
    echo '#!/usr/bin/env bash'
    echo "# Hadoop's \`$name\` for the cluster in $folder; written by cluster.sh."
    echo 'set -euo pipefail'
    # shellcheck disable=SC2016
    echo 'case ${1:-} in'
    for pair; do echo "  ${pair%%=*}) class=org.apache.hadoop.${pair#*=} ;;"; done
    echo "  *) echo \"$name: no such command here: \${1:-}\" >&2; exit 1 ;;"
    echo 'esac'
    echo 'shift'
    echo "exec '$JAVA_HOME/bin/java' -Xmx256m -XX:+UseSerialGC -XX:TieredStopAtLevel=1 -Djava.net.preferIPv4Stack=true $opens \\"
    echo "  -Dvesalius.log=\"\${HADOOP_ROOT_LOGGER:-INFO,console}\" -Dvesalius.logfile=/dev/null \\"
    echo "  -cp '$folder/conf:$lib/*' \"\$class\" \"\$@\""
  } > "$folder/bin/$name"
  chmod +x "$folder/bin/$name"
}

write_commands() {
  write_command mapred streaming=streaming.HadoopStreaming job=mapred.JobClient
  write_command hdfs dfs=fs.FsShell dfsadmin=hdfs.tools.DFSAdmin getconf=hdfs.tools.GetConf
  write_command yarn node=yarn.client.cli.NodeCLI application=yarn.client.cli.ApplicationCLI logs=yarn.client.cli.LogsCLI
  cat > "$folder/env.sh" << EOF
# To be sourced; written by cluster.sh.
export JAVA_HOME='$JAVA_HOME'
export HADOOP_CONF_DIR='$folder/conf'
export PATH='$folder/bin':"\$PATH"
export VESALIUS_HDFS='webhdfs://127.0.0.1:$port_namenode_http'
export VESALIUS_HADOOP_PAGES='http://127.0.0.1:$port_rm_http (YARN) http://127.0.0.1:$port_namenode_http (HDFS) http://127.0.0.1:$port_history_http (finished jobs)'
EOF
}

# --- daemons ----------------------------------------------------------------------------------------------------------

hadoop_java() {  # DAEMON JAVA-ARGUMENTS...: becomes that JVM
  local daemon=$1
  shift
  cd "$folder"
  LD_PRELOAD=$preload exec "$JAVA_HOME/bin/java" "-Dvesalius.daemon=$folder:$daemon" -Xmx128m -XX:+UseSerialGC -XX:TieredStopAtLevel=1 \
    -Djava.net.preferIPv4Stack=true ${opens:+$opens} -Dhadoop.log.dir="$folder/log" \
    -Dvesalius.log=INFO,file -Dvesalius.logfile="$folder/log/$daemon.log" -cp "$folder/conf:$lib/*" "$@"
}

launch() {  # DAEMON
  local daemon=$1 n=${1: -1} java=()
  case $daemon in
    namenode) java=(org.apache.hadoop.hdfs.server.namenode.NameNode) ;;
    datanode*) java=("-Dvesalius.name=data$n" org.apache.hadoop.hdfs.server.datanode.DataNode) ;;
    resourcemanager) java=(org.apache.hadoop.yarn.server.resourcemanager.ResourceManager) ;;
    nodemanager*)
      local port="port_node$n" localizer="port_node${n}_localizer" http="port_node${n}_http"
      java=("-Dvesalius.name=node$n" "-Dvesalius.port=${!port}" "-Dvesalius.localizer=${!localizer}" "-Dvesalius.http=${!http}"
        org.apache.hadoop.yarn.server.nodemanager.NodeManager)
      ;;
    historyserver) java=(org.apache.hadoop.mapreduce.v2.hs.JobHistoryServer) ;;
  esac
  rm -f "$folder/log/$daemon.log"  # what is_up looks for must be this start's
  # A session of its own: the daemon outlives the caller's terminal and does not get its Ctrl-C.
  export folder lib preload opens JAVA_HOME
  setsid bash -c "$(declare -f hadoop_java); hadoop_java \"\$@\"" - "$daemon" "${java[@]}" \
    < /dev/null > "$folder/log/$daemon.out" 2>&1 &
  disown
}

get() {  # URL
  curl -sf --noproxy '*' --max-time 5 "$1"
}

is_up() {  # DAEMON
  case $1 in
    # All data nodes are there and HDFS can be written.
    namenode) get "http://127.0.0.1:$port_namenode_http/jmx?qry=Hadoop:service=NameNode,name=FSNamesystemState" | tr -d ' \n' |
      grep -q '"FSState":"Operational".*"NumLiveDataNodes":2' ;;
    resourcemanager) get "http://127.0.0.1:$port_rm_http/ws/v1/cluster/info" | grep -q '"state":"STARTED"' ;;
    nodemanager*) grep -q 'Registered with ResourceManager' "$folder/log/$1.log" 2> /dev/null ;;
    historyserver) get "http://127.0.0.1:$port_history_http/ws/v1/history/info" > /dev/null ;;
  esac
}

wait_for() {  # DAEMON...
  local daemon one
  for daemon; do
    until is_up "$daemon"; do
      for one in "${launched[@]}"; do
        runs "$one" || fail "$one died: $(cat "$folder/log/$one.out" "$folder/log/$one.log" 2> /dev/null |
          grep -E 'ERROR|FATAL|Exception' | head -n 1 | cut -c 1-300) (see $folder/log)"
      done
      ((SECONDS < kSecondsToStart)) || fail "$daemon is not up after $kSecondsToStart s (see $folder/log)"
      sleep 0.2
    done
  done
}

# The folders that Hadoop expects of every HDFS: one for anybody's scratch files and a home.
make_hdfs_folders() {
  local user one url="http://127.0.0.1:$port_namenode_http/webhdfs/v1"
  user=$(id -un)
  for one in "tmp?permission=1777&" "user/$user?"; do
    curl -sf --noproxy '*' -o /dev/null -X PUT "$url/${one}op=MKDIRS&user.name=$user" ||
      fail "cannot make folders in HDFS"
  done
}

start() {
  local daemon missing=()
  mkdir -p "$folder/bin" "$folder/log" "$folder/hdfs" "$lib"
  for daemon in "${kDaemons[@]}"; do
    runs "$daemon" || missing+=("$daemon")
  done
  if ((${#missing[@]} == 0)); then
    echo "runs already"
    return
  fi
  fetch_jars
  build_loopback_library
  SECONDS=0
  local begin
  begin=$(date +%s%N)
  if ((${#missing[@]} == ${#kDaemons[@]})); then
    kill_containers_of 1
    kill_containers_of 2
    choose_ports
  fi
  write_configuration
  write_commands
  if [[ ! -e $folder/hdfs/name/current/VERSION ]]; then
    rm -rf "$folder/hdfs"
    (hadoop_java format org.apache.hadoop.hdfs.server.namenode.NameNode -format -nonInteractive) > "$folder/log/format.out" 2>&1 ||
      fail "cannot format HDFS (see $folder/log/format.out)"
  fi
  trap 'if (($? != 0)); then stop > /dev/null; fi' EXIT  # no half a cluster stays behind
  launched=()
  for daemon in "${missing[@]}"; do
    # The history server tries only every 10 s to make its folders: it comes when they can be made.
    if [[ $daemon == historyserver ]]; then
      wait_for namenode
      make_hdfs_folders
    fi
    launch "$daemon"
    launched+=("$daemon")
  done
  sleep 0.5  # until the last is exec'ed under its name
  wait_for namenode resourcemanager nodemanager1 nodemanager2 historyserver
  trap - EXIT
  echo "up after $(awk "BEGIN { printf \"%.1f\", ($(date +%s%N) - $begin) / 1e9 }") s; to use it: source $folder/env.sh"
}

end() {  # DAEMON...: asks them to end, and makes them if that takes more than 10 s
  local signal i daemon pids
  for signal in TERM KILL; do
    for ((i = 0; i < 100; ++i)); do
      pids=$(for daemon; do pids_of "$daemon"; done)
      [[ -z $pids ]] && return
      # shellcheck disable=SC2086
      ((i > 0)) || kill "-$signal" $pids 2> /dev/null || true
      sleep 0.1
    done
  done
  fail "processes do not end: $pids"
}

stop() {
  # A daemon that cannot take leave of the one it depends on tries for long.
  end nodemanager1 nodemanager2 historyserver
  end resourcemanager datanode1 datanode2
  end namenode
  kill_containers_of 1
  kill_containers_of 2
  echo "stopped"
}

status() {
  local daemon pids result=0
  for daemon in "${kDaemons[@]}"; do
    pids=$(pids_of "$daemon" | tr '\n' ' ')
    printf '%-16s %s\n' "$daemon" "${pids:-does not run}"
    [[ -n $pids ]] || result=1
  done
  return "$result"
}

kill_node() {  # N
  local pids
  pids=$(pids_of "nodemanager$1")
  [[ -n $pids ]] || echo "nodemanager$1 does not run"
  # shellcheck disable=SC2086
  [[ -z $pids ]] || kill -9 $pids
  kill_containers_of "$1"
}

start_node() {  # N
  if runs "nodemanager$1"; then
    echo "runs already"
    return
  fi
  runs resourcemanager || fail "the cluster in $folder does not run"
  build_loopback_library
  # shellcheck source=/dev/null
  source "$folder/ports"
  SECONDS=0
  launch "nodemanager$1"
  launched=("nodemanager$1")
  sleep 0.5
  wait_for "nodemanager$1"
}

# ----------------------------------------------------------------------------------------------------------------------

(($# >= 2)) || usage
command=$1
folder=$(realpath -m "$2")
lib=$(realpath -m "${VESALIUS_HADOOP_LIB:-$folder/lib}")
opens="--add-opens=java.base/java.lang=ALL-UNNAMED --add-opens=java.base/java.util=ALL-UNNAMED"
# Both stand in XML, in class paths and in the scripts that start containers.
[[ $folder$lib =~ ^[A-Za-z0-9_./+-]+$ ]] || fail "only letters, digits and _./+- in the path of the folder, please: $folder $lib"
case $command in
  start | stop | status) (($# == 2)) || usage ;;
  kill-node | start-node) [[ $# == 3 && $3 =~ ^[12]$ ]] || usage ;;
  *) usage ;;
esac
case $command in
  start)
    find_java
    start
    ;;
  stop) stop ;;
  status) status ;;
  kill-node) kill_node "$3" ;;
  start-node)
    find_java
    start_node "$3"
    ;;
esac
