#!/usr/bin/env bash
# One job without an engine, for `vesalius train --on script:examples/cluster/plain_job.sh` (docs/cluster.md): one map
# task after the other, and one reduce task.
set -euo pipefail
lines=$1 out=$2
mkdir "$out"
if [ "$VESALIUS_REDUCE_TASKS" = 0 ]; then
  bash -c "$VESALIUS_MAP" <"$lines" >"$out/part-0"
else
  split -n "l/$VESALIUS_MAP_TASKS" --filter 'bash -c "$VESALIUS_MAP"' "$lines" | LC_ALL=C sort |
    bash -c "$VESALIUS_REDUCE" >"$out/part-0"
fi
