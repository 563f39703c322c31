#!/usr/bin/env bash
# The plugin as installed: one file for ParaView to load, the list that names it and the licence.
. "$(dirname "$0")/installed.sh"
install_components "$1" paraview_plugin
folder=$(cd "$work/prefix" && dirname "$(find . -name 'MidSurface.so' -printf '%P\n')")
expect_files "$folder/MidSurface.so" "$(dirname "$folder")/midsurface.plugins.xml" \
  share/doc/midsurface-paraview/copyright

cat >"$work/load.py" <<'PYTHON'
import sys
from paraview import simple

simple.LoadPlugin(sys.argv[1], remote=False, ns=globals())
print(MidSurface)
PYTHON
pvpython "$work/load.py" "$work/prefix/$folder/MidSurface.so"
