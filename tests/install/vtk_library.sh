#!/usr/bin/env bash
# The library for VTK as installed: examples/cxx built outside the source tree, and examples/python.
. "$(dirname "$0")/installed.sh"
build=$1 sample=$2 vtk_folder=$3 vtk_python=$4
install_components "$build" runtime development python

cp -r "$source/examples/cxx" "$work/example"
cmake -S "$work/example" -B "$work/example/build" -DCMAKE_PREFIX_PATH="$work/prefix" \
  -DVTK_DIR="$vtk_folder" >"$work/log" 2>&1 || {
  cat "$work/log"
  exit 1
}
cmake --build "$work/example/build"
"$work/example/build/mid_surface" "$sample" "$work/cxx.vtp"

export PYTHONPATH
PYTHONPATH=$(dirname "$(find "$work/prefix" -type d -name midsurface)"):$vtk_python
/usr/bin/python3 "$source/examples/python/mid_surface.py" "$sample" "$work/python.vtp"
cmp "$work/cxx.vtp" "$work/python.vtp"
/usr/bin/python3 "$source/tests/install/check_mesh.py" "$work/cxx.vtp"
