# What the tests of packages say; they read this file.

skip() {
  echo "SKIPPED: $*"
  exit 77
}
fail() {
  echo "$(basename "$0"): $*" >&2
  exit 1
}
step() { printf -- '--- %s (%d:%02d)\n' "$1" $((SECONDS / 60)) $((SECONDS % 60)); }
