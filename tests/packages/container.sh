#!/usr/bin/env bash
# The image of Containerfile, built of the sources as they lie here: it finds the demo's people without a network, as another user than
# root, shows them to a browser, and writes into a folder that it is given. Debian comes from its registry, else from debootstrap.
# Root only; buildah's chroot takes the place of podman, so that it runs within containers too.
# usage: container.sh PROGRAM; PROGRAM is the build's
set -euo pipefail
program="$(realpath "$1")"
source="$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")"

. "$source/tests/packages/say.sh"

[ "$(id -u)" = 0 ] || skip "debootstrap needs root"
for tool in buildah debootstrap python3; do
  command -v "$tool" >/dev/null || skip "no $tool"
done

work="$(mktemp -d)"
images=(buildah --root "$work/images" --runroot "$work/run" --storage-driver vfs)
trap '"${images[@]}" rm --all >/dev/null 2>&1 || true; rm -rf --one-file-system "$work"' EXIT

debian=docker.io/library/debian:12
step "Debian"
if ! timeout 300 "${images[@]}" pull -q "$debian" >/dev/null 2>&1; then
  echo "no registry of images; Debian by debootstrap"
  mirror="$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' 'Release: bookworm' 2>/dev/null | head -n 1)"
  debootstrap --variant=minbase bookworm "$work/debian" ${mirror:+"$mirror"} >"$work/log" 2>&1 ||
    { tail -n 20 "$work/log"; fail "debootstrap failed"; }
  tar -C "$work/debian" -cf "$work/debian.tar" .
  rm -rf "$work/debian"
  debian=localhost/debian:12
  empty="$("${images[@]}" from scratch)"
  "${images[@]}" add -q "$empty" "$work/debian.tar" / >/dev/null
  "${images[@]}" commit -q --rm "$empty" "$debian" >/dev/null
  rm "$work/debian.tar"
fi

step "build"
"${images[@]}" bud --isolation chroot --build-arg DEBIAN="$debian" -t vesalius "$source" >"$work/log" 2>&1 ||
  { tail -n 40 "$work/log"; fail "the image cannot be built"; }
"${images[@]}" images --format '{{.Name}} {{.Size}}' | grep vesalius
container="$("${images[@]}" from vesalius)"
[ "$("${images[@]}" inspect --format '{{.OCIv1.Config.Entrypoint}}' vesalius)" = "[vesalius]" ] || fail "expected the program as entry point"
# run FLAG... CONTAINER -- COMMAND...: buildah leaves the entry point out.
run() { "${images[@]}" run --isolation chroot "$@"; }

step "user"
[ "$(run "$container" -- id -un)" = vesalius ] || fail "expected the user vesalius"

step "detect"
"$program" detect "$source/data/demo" --json - -q >"$work/wanted.jsonl"
[ "$(tail -n 1 "$work/wanted.jsonl")" = '{"complete":true,"frames":120}' ] || fail "expected 120 frames of the demo"
run --volume "$source/data/demo:/data/demo:ro" "$container" -- vesalius detect demo --json - -q >"$work/found.jsonl"
cmp "$work/wanted.jsonl" "$work/found.jsonl"

step "a folder to write to"
install -d -o 1000 -g 1000 "$work/mine"
run --volume "$work/mine:/data" "$container" -- vesalius detect /usr/share/vesalius/demo --json people.jsonl
cmp "$work/wanted.jsonl" "$work/mine/people.jsonl"

step "view"
coproc view { exec "${images[@]}" run --isolation chroot "$container" -- vesalius view /usr/share/vesalius/demo --port 0 --folder /tmp; }
read -r -t 60 address <&"${view[0]}"
python3 "$source/tests/packages/view_answers.py" "$address"
kill "$view_PID"
wait "$view_PID" || true
step "passed"
