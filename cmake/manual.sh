#!/usr/bin/env bash
# Writes the manual with help2man, compressed: a page for the program and one for each command, commands of commands too. They
# say what --help says and carry no date: the same program gives the same bytes.
#
# usage: manual.sh VESALIUS FOLDER
set -euo pipefail
program="$1" pages="$2"
version="$("$program" --version | sed 's/ /) /')"  # "vesalius) 1.2.3"
as_named="$(mktemp -d)"  # a page has the name of what is run for it
trap 'rm -rf "$as_named"' EXIT

# All options that a file can hold, with help, unit, range and default, for the page of `vesalius options`.
options_of_files() {
  local of
  for of in detect $("$program" --help | grep -oE '^  (synth|train) ' || true); do
    printf '[options of %s]\n.nf\n' "$of"
    "$program" options "$of" | sed 's/\\/\\(rs/g; s/-/\\-/g; s/^\./\\\&./'
    echo .fi
  done
}

# page vesalius [COMMAND...]
page() {
  local name more=() help inner
  name="$(IFS=- && echo "$*")"
  help="$("$program" "${@:2}" --help)"
  # "-q,--quiet" apart, and two spaces before what is said of a flag of any length: else help2man takes neither for a flag.
  printf '#!/bin/sh\n"%s" %s "$@" | sed -E "s/^(  -.{25}[^ ]) /\\1  /; s/^  (-.),-/  \\1, -/"\n' "$program" "${*:2}" >"$as_named/$name"
  chmod +x "$as_named/$name"
  if [ "$name" = vesalius-options ]; then
    options_of_files >"$as_named/included"
    more=(--include "$as_named/included")
  fi
  help2man --no-info --name "$(head -n 1 <<<"$help")" --version-string "$name ($version" "${more[@]}" "$as_named/$name" |
    sed 's/^\(\.TH [^"]*"1"\) "[^"]*"/\1 ""/' | gzip -9n >"$pages/$name.1.gz"
  for inner in $(sed -n '/^Subcommands:/,/^$/s/^  \([a-z0-9]*\) .*/\1/p' <<<"$help"); do
    page "$@" "$inner"
  done
}

rm -rf "$pages"
mkdir -p "$pages"
page vesalius
