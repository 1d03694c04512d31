#!/usr/bin/env bash
# Makes docs/images/people.webp: two rendered people who walk past each other, as `vesalius detect --track` finds them.
# usage: animation.sh VESALIUS OUT.webp. Needs ffmpeg, and the bodies of `vesalius assets makehuman`.
set -euo pipefail
if [ $# -ne 2 ]; then
  sed -n 3p "$0" >&2
  exit 2
fi
program="$1" out="$2"
if ! command -v ffmpeg >/dev/null; then
  echo "SKIPPED: no ffmpeg" >&2
  exit 77
fi
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
# A clip of six seconds at ten frames a second. The tenth of ten seeds that were looked at: both people are in view and cross.
"$program" synth -q --clip 6 --rate 10 --count 1 --seed 10 --format folder --out "$work/clip" \
  --body.kind makehuman --body.count 10 --pose.captured 0 --sensor.colour --scene.detail 0.5 --scene.nobody-share 0 --scene.border-share 0 \
  --people.none 0 --people.one 0 --people.two 1 --people.three 0 --people.four 0 \
  --clip.moving-share 0 --clip.walking-share 1 --clip.crossing-share 1 --clip.leaving-share 0 \
  --camera.distance-min 2 --camera.distance-max 4 --camera.height-min 1 --camera.height-max 1.6 --camera.pitch-max 15
"$program" detect "$work/clip" -q --track --rate 10 --save overlay --out "$work/found"
ffmpeg -v error -y -framerate 10 -pattern_type glob -i "$work/found/overlay/*.png" -vf scale=400:-1:flags=lanczos -loop 0 -quality 40 \
  -compression_level 6 "$work/people.webp"
mv "$work/people.webp" "$out"
ls -l "$out"
