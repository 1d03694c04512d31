#!/usr/bin/env bash
# Makes docs/images/people.webp and demo.webp: the people of data/demo, as `vesalius detect` follows them, and four of its pictures.
# usage: animation.sh VESALIUS FOLDER. Needs ffmpeg.
set -euo pipefail
if [ $# -ne 2 ]; then
  sed -n 3p "$0" >&2
  exit 2
fi
program="$1" folder="$2"
if ! command -v ffmpeg >/dev/null; then
  echo "SKIPPED: no ffmpeg" >&2
  exit 77
fi
demo="$(dirname "$0")/../../data/demo"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
"$program" detect "$demo" -q --save overlay,parts --out "$work"
# Every second frame, at half the rate.
ffmpeg -v error -y -framerate 15 -i "$work/overlay/%03d.png" -vf "select='not(mod(n,2))',setpts=N/7.5/TB,scale=400:-1:flags=lanczos" -r 7.5 \
  -loop 0 -quality 34 -compression_level 6 "$work/people.webp"
# Somebody passes behind another, who falls while the third sits down; the body parts of all.
ffmpeg -v error -y -i "$work/overlay/027.png" -i "$work/overlay/063.png" -i "$work/overlay/096.png" -i "$work/parts/063.png" \
  -filter_complex "[3:v]crop=640:480:0:0[p];[0:v][1:v][2:v][p]xstack=inputs=4:layout=0_0|w0_0|0_h0|w0_h0,scale=960:-1:flags=lanczos" \
  -frames:v 1 -quality 70 -compression_level 6 "$work/demo.webp"
mv "$work/people.webp" "$work/demo.webp" "$folder"
ls -l "$folder/people.webp" "$folder/demo.webp"
