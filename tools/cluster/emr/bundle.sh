#!/usr/bin/env bash
# A build of vesalius with all libraries that it needs, for machines of another distribution, such as Amazon's EMR
# (docs/cluster.md).
#
#   bundle.sh PROGRAM ASSETS FILE.tar.gz    ASSETS is the folder of `vesalius assets`
#
# Unpacked in /opt, it is /opt/vesalius/vesalius, and the assets are /opt/vesalius/assets.
set -euo pipefail
[ $# = 3 ] || { sed -n '5,7s/^# *//p' "$0" >&2; exit 2; }
[ -x "$1" ] && [ -f "$1" ] || { echo "bundle.sh: $1: expected a program" >&2; exit 1; }
[ -d "$2" ] || { echo "bundle.sh: $2: expected the folder of the assets" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder" "$3.part"' EXIT
mkdir -p "$folder/vesalius/lib"
ldd "$1" | sed -nE 's/.* => (\/[^ ]+) .*/\1/p; s/^\s*(\/[^ ]+) .*/\1/p' | xargs cp -L -t "$folder/vesalius/lib"
cp "$1" "$folder/vesalius/lib/vesalius"
cp -r "$2" "$folder/vesalius/assets"
# The bundle's own loader: LD_LIBRARY_PATH would give these libraries to mapred and sort as well.
cat >"$folder/vesalius/vesalius" <<'END'
#!/bin/sh
lib=/opt/vesalius/lib
exec $lib/ld-linux-x86-64.so.2 --library-path $lib $lib/vesalius "$@"
END
chmod +x "$folder/vesalius/vesalius"
tar -C "$folder" -czf "$3.part" vesalius
mv "$3.part" "$3"
