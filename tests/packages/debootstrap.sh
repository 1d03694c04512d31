#!/usr/bin/env bash
# Packages in a Debian 12 that has nothing else: installed with what they depend on, then run without a network, built against,
# and removed; and what lintian says of them. Takes the mirror that apt has on this machine, else Debian's own. Root only.
# usage: debootstrap.sh FOLDER PROGRAM; FOLDER has the packages and the archive, PROGRAM is the build's
set -euo pipefail
packages="$(realpath "$1")"
program="$(realpath "$2")"
source="$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")"

. "$source/tests/packages/say.sh"

[ "$(id -u)" = 0 ] || skip "debootstrap needs root"
for tool in debootstrap lintian unshare ip python3; do
  command -v "$tool" >/dev/null || skip "no $tool"
done
unshare --mount --net --pid --fork true 2>/dev/null || skip "no namespaces of its own"

work="$(mktemp -d)"
root="$work/debian"
trap 'rm -rf --one-file-system "$work"' EXIT

# inside COMMAND...: in that Debian, with this machine's network; offline COMMAND...: with none but its own loopback.
clean=(chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive)
inside() { unshare --mount --pid --fork --kill-child --mount-proc="$root/proc" "${clean[@]}" "$@"; }
offline() { unshare --net --mount --pid --fork --kill-child --mount-proc="$root/proc" "${clean[@]}" "$@"; }

step "lintian"
lintian --allow-root --info --fail-on error,warning "$packages"/*.deb

step "an empty Debian"
mirror="$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Release: bookworm' 2>/dev/null | head -n 1)"
debootstrap --variant=minbase bookworm "$root" ${mirror:+"$mirror"} >"$work/debootstrap.log" 2>&1 ||
  { tail -n 20 "$work/debootstrap.log"; fail "debootstrap failed"; }
# What leads this machine to the mirror.
{
  apt-config dump 2>/dev/null | grep -E '^Acquire::(https?::Proxy|Check-|Retries)' || true
  echo 'Dpkg::Use-Pty "false";'
} >"$root/etc/apt/apt.conf.d/90machine"
echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/unsafe"  # nothing here outlives this script
[ -z "$(find "$root" -xdev -name '*vesalius*')" ] || fail "vesalius was there before"

# install PACKAGE...: says nothing unless it fails.
install() {
  inside bash -c 'apt-get -qq install -y --no-install-recommends "$@"' - "$@" >"$work/install.log" 2>&1 ||
    { tail -n 20 "$work/install.log"; fail "apt install $* failed"; }
}

step "apt install"
cp "$packages"/*.deb "$packages"/vesalius-*-linux-*.tar.gz "$root/root/"
inside apt-get -qq update
install man-db
for deb in "$packages"/vesalius_*.deb; do
  install "/root/$(basename "$deb")"
done
inside dpkg --verify vesalius
inside dpkg --listfiles vesalius >"$work/files"

step "detect, without network"
"$program" detect "$source/data/demo" --json - -q >"$work/wanted.jsonl"
[ "$(tail -n 1 "$work/wanted.jsonl")" = '{"complete":true,"frames":120}' ] || fail "expected 120 frames of the demo"
offline vesalius detect /usr/share/vesalius/demo --json - -q >"$work/found.jsonl"
cmp "$work/wanted.jsonl" "$work/found.jsonl"
offline vesalius detect /usr/share/vesalius/demo

step "view, without network"
unshare --net --mount --pid --fork --kill-child --mount-proc="$root/proc" bash -c '
  set -euo pipefail
  ip link set lo up
  coproc view { exec "${@:2}" vesalius view /usr/share/vesalius/demo --no-browser --port 0 --folder /tmp; }
  read -r -t 60 address <&"${view[0]}"
  echo "$address"
  python3 "$1" "$address"' - "$source/tests/packages/view_answers.py" "${clean[@]}"

step "info, manual, completion"
offline vesalius info | head -n 2
for page in $(grep -o 'vesalius[a-z0-9-]*\.1\.gz' "$work/files"); do
  said="$(offline man --warnings -E UTF-8 -l -Tutf8 -Z "/usr/share/man/man1/$page" 2>&1 >/dev/null)"
  [ -z "$said" ] || fail "man says of $page: $said"
done
offline man vesalius-detect | grep -e --json
offline man vesalius-options | grep 'min-parts ='
offline bash -c '. /usr/share/bash-completion/completions/vesalius; COMP_WORDS=(vesalius det); COMP_CWORD=1; _vesalius
  [ "${COMPREPLY[*]}" = detect ]'

step "archive"
inside bash -c 'mkdir /opt/anywhere && tar -C /opt/anywhere -xzf /root/vesalius-*-linux-*.tar.gz'
offline bash -c 'cd / && /opt/anywhere/vesalius-*/bin/vesalius detect /opt/anywhere/vesalius-*/share/vesalius/demo --json - -q' >"$work/unpacked.jsonl"
cmp "$work/wanted.jsonl" "$work/unpacked.jsonl"

step "libraries"
install $(cd "$packages" && printf '/root/%s ' libvesalius[0-9]*.deb libvesalius-dev_*.deb) g++ gcc cmake make pkg-config
inside bash -c 'dpkg --verify $(dpkg-query --show --showformat "${Package} " "libvesalius*")'
cp -r "$source/tests/consumer" "$source/examples" "$root/root/"
offline bash -c 'cd /root && cmake -S consumer -B build -DEXAMPLES=/root/examples \
  -DVESALIUS_HEADERS="$(echo /usr/include/vesalius-*)" >/dev/null && cmake --build build --target detect_people >/dev/null &&
  build/detect_people/detect_people /usr/share/vesalius/models/default.forest /usr/share/vesalius/demo'

# In C, with the model that it finds by itself; a picture without readings has nobody.
offline bash -c 'cd /root && gcc -std=c99 examples/detect_people.c $(pkg-config --cflags --libs vesalius) -lm -o detect &&
  ldd detect | grep libvesalius && head -c 614400 /dev/zero >none && ./detect - none 640 480 525 525 319.5 239.5'

step "purge"
inside apt-get -qq purge -y vesalius 'libvesalius*' >/dev/null
while read -r file; do
  [[ "$file" != *vesalius* ]] || [ ! -e "$root$file" ] || fail "purge leaves $file"
done <"$work/files"
left="$(find "$root" -xdev -name '*vesalius*' -not -path "$root/root/*" -not -path "$root/opt/*" -not -path "$root/var/cache/man/*")"  # man keeps what it showed
[ -z "$left" ] || fail "purge leaves $left"
step "passed"
