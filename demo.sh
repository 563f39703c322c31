#!/usr/bin/env bash
# From nothing to a mid-surface: installs, builds, makes a sample (or takes the file named), runs
# the filter in pvpython, writes the mesh and a picture to demo-output/.
set -euo pipefail

if [ "${1:-}" = --help ] || [ "${1:-}" = -h ] || [ $# -gt 1 ]; then
  cat <<'HELP'
usage: ./demo.sh [FILE]

Extracts the mid-surface of every label in FILE, a segmented volume that ParaView can read (.mrc,
.vti, .nrrd, .tif and others); without FILE, of a made-up mitochondrion. Writes the mesh (.vtp) and
a picture (.png) to demo-output/. Installs what is missing with apt-get (Debian 12).
HELP
  [ $# -le 1 ] && exit 0
  exit 2
fi

input=
if [ $# = 1 ]; then
  [ -r "$1" ] && [ ! -d "$1" ] || {
    printf 'demo.sh: %s cannot be read: no such file?\n' "$1" >&2
    exit 2
  }
  input=$(realpath "$1")
fi

cd "$(dirname "$0")"
. scripts/build.sh
install_packages "${build_packages[@]}" "${display_packages[@]}"
install_rust
build_all

mkdir -p demo-output
if [ -z "$input" ]; then
  say "Making a sample"
  input=$PWD/demo-output/mitochondrion.vti
  cargo run --quiet --locked --release --package phantoms --bin make-sample -- "$input"
fi

say "Extracting the mid-surface of $input"
with_display pvpython --force-offscreen-rendering scripts/demo.py "$plugin" "$input" demo-output

cat <<EOF

To use it in your own ParaView 5.11: Tools > Manage Plugins > Load New, choose the file below, tick
Auto Load; then open a segmentation and pick Filters > Mid-Surface > Mid-Surface, Apply.
In pvpython: LoadPlugin("$plugin", remote=False, ns=globals())

plugin: $plugin
EOF
