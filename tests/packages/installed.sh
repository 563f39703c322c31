#!/usr/bin/env bash
# As root: installs the packages in $1/packages, tries them and removes them.
set -euo pipefail
cd "$1"
export DEBIAN_FRONTEND=noninteractive LANG=C.UTF-8
# As for users, whose Python leaves compiled files behind.
unset PYTHONDONTWRITEBYTECODE
conf=/usr/bin/paraview.conf
work=$(mktemp -d)

say() { printf '\n-- %s\n' "$*"; }
fail() {
  echo "failed: $*" >&2
  exit 1
}
install() { apt-get install -y -qq --no-install-recommends "$@" >"$work/log" 2>&1 || {
  cat "$work/log"
  fail "apt-get install $*"
}; }
purge() { apt-get purge -y -qq "$@" >/dev/null; }
expect_conf() { [ "$(cat "$conf")" = "$1" ] || fail "$conf holds: $(cat "$conf")"; }

say "The plugin: there without being loaded"
[ ! -e "$conf" ] || fail "$conf is there already"
apt-get update -qq
install ./packages/midsurface-paraview_*.deb
list=$(dpkg -L midsurface-paraview | grep 'plugins\.xml$')
expect_conf "$list"
cat >"$work/extract.py" <<'PYTHON'
import sys
from paraview import servermanager
from paraview.simple import *

if len(sys.argv) > 2:
    Connect("localhost", int(sys.argv[2]))
segmentation = OpenDataFile(sys.argv[1])
segmentation.UpdatePipeline()
mid_surface = MidSurface(Input=segmentation)
mid_surface.UpdatePipeline()
mesh = servermanager.Fetch(mid_surface)
assert mesh.GetNumberOfPolys() > 1000, mesh.GetNumberOfPolys()
print("ok:", mesh.GetNumberOfPolys(), "triangles")
PYTHON
pvpython "$work/extract.py" vesicle.vti
pvbatch --force-offscreen-rendering "$work/extract.py" vesicle.vti
say "The same on a server"
pvserver --server-port=11731 --force-offscreen-rendering >"$work/server.log" 2>&1 &
server=$!
for _ in $(seq 60); do
  grep -q 'Accepting connection' "$work/server.log" && break
  sleep 0.5
done
pvpython "$work/extract.py" "$PWD/vesicle.vti" 11731
kill "$server" 2>/dev/null || true
say "The same in the window"
bash gui/run.sh vesicle.vti $work/picture.png

say "The plugin: removed without a trace, lines of others kept"
purge midsurface-paraview
[ ! -e "$conf" ] || fail "$conf stays behind"
printf '/opt/other.plugins.xml' >"$conf" # no newline at its end
install ./packages/midsurface-paraview_*.deb
install --reinstall ./packages/midsurface-paraview_*.deb
expect_conf "/opt/other.plugins.xml
$list"
purge midsurface-paraview
expect_conf /opt/other.plugins.xml
rm "$conf"
[ ! -e "$list" ] || fail "$list stays behind"

say "The libraries: C++, Python and C programs find them where they are"
install ./packages/libmidsurface*.deb ./packages/python3-midsurface_*.deb python3-paraview-
cmake -S examples/cxx -B "$work/cxx" >"$work/log" 2>&1 || {
  cat "$work/log"
  fail "find_package(MidSurface)"
}
cmake --build "$work/cxx"
"$work/cxx/mid_surface" vesicle.vti "$work/cxx.vtp"
/usr/bin/python3 examples/python/mid_surface.py vesicle.vti "$work/python.vtp"
cmp "$work/cxx.vtp" "$work/python.vtp"
# Words on purpose: these are lists of flags.
# shellcheck disable=SC2046
cc -std=c11 examples/c/vesicle.c $(pkg-config --cflags --libs midsurface) -o "$work/vesicle"
"$work/vesicle" "$work/vesicle.obj"
purge 'libmidsurface*' python3-midsurface
left=$(find /usr -iname '*midsurface*' -not -path '/usr/local/*')
[ -z "$left" ] || fail "left behind: $left"
rm -rf "$work"
echo "the packages can be installed, used and removed"
