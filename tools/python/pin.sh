#!/usr/bin/env bash
# Writes beside each list of Python packages, NAME.in, what is installed of it: NAME.txt, exact versions for every Python that the
# list is for and the hashes of all their files. CI installs these alone (pip --require-hashes).
# usage: pin.sh [--upgrade]   without: versions that fit stay, with: the newest that there are
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

python3 -m venv build/pin
build/pin/bin/pip install -q --require-hashes -r tools/python/pins/pin.txt
for list in tools/python/pins/*.in training/network/requirements.in training/network/tests/requirements.in; do
  oldest="$(sed -n 's/^# Python \([0-9.]*\) and later.*/\1/p' "$list")"
  build/pin/bin/uv pip compile "$list" -o "${list%.in}.txt" -q "$@" --universal --python-version "$oldest" --generate-hashes --no-annotate \
    --custom-compile-command tools/python/pin.sh
done
