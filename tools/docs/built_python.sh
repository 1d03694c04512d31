#!/bin/sh
# The Python that ./dev python made, with the package that it built.
build="$(dirname "$(readlink -f "$0")")/../../build"
PYTHONPATH="$build/python/package" exec "$build/python-venv/python3/bin/python" "$@"
