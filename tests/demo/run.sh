#!/usr/bin/env bash
# demo.sh as a user calls it: on its own sample, on files of the kinds users have, on bad input.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/build.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0

check() {
  local what=$1
  shift
  if "$@"; then
    passed=$((passed + 1))
    echo "ok: $what"
  else
    [ ! -f "$work/log" ] || cat "$work/log"
    fail "failed: $what"
  fi
}

demo() { ./demo.sh "$@" >"$work/log" 2>&1 </dev/null; }
fails_with_message() { ! demo "$2" && grep -q -- "$1" "$work/log"; }
sample() {
  cargo run --quiet --locked --release --package phantoms --bin make-sample -- "$@"
}
mesh_and_picture() {
  [ -s "demo-output/$1-mid-surface.vtp" ] && [ "$(head -c 4 "demo-output/$1-mid-surface.png" |
    tail -c 3)" = PNG ]
}
table_line() { grep -Eq "^ *$1 \| +[1-9][0-9]* \| +[1-9][0-9]* \| +[1-9][0-9]* " "$work/log"; }
plugin_exists() { [ -f "$(sed -n 's/^plugin: //p' "$work/log")" ]; }

rm -rf demo-output
check "the sample" demo
check "its mesh and picture" mesh_and_picture mitochondrion
check "a line for the outer membrane" table_line 1
check "a line for the inner membrane" table_line 2
check "the plugin's path" plugin_exists

sample "$work/tube with spaces.mrc" tube --size 64 64 32
check "an MRC file with spaces in its name" demo "$work/tube with spaces.mrc"
check "its mesh and picture" mesh_and_picture "tube with spaces"

check "a file that is not there" fails_with_message "cannot be read" "$work/absent.mrc"
echo "not a volume" >"$work/text.vti"
check "a file that holds no volume" fails_with_message "cannot open" "$work/text.vti"
cat >"$work/empty.vti" <<'VTI'
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">
<ImageData WholeExtent="0 1 0 1 0 1" Origin="0 0 0" Spacing="1 1 1">
<Piece Extent="0 1 0 1 0 1"><PointData Scalars="Labels">
<DataArray type="UInt8" Name="Labels" format="ascii">0 0 0 0 0 0 0 0</DataArray>
</PointData></Piece></ImageData></VTKFile>
VTI
check "a volume without a label" fails_with_message "no mesh was made" "$work/empty.vti"

echo "$passed passed, 0 failed"
