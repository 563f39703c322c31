#!/usr/bin/env bash
# The filter in ParaView's real window, driven by the menus and buttons a user would press.
#
#     run.sh VOLUME.vti PICTURE.png [PLUGIN]
#
# Opens the volume, extracts, colours by thickness and leaves a picture of the window. Where PLUGIN
# is named it is loaded first; otherwise ParaView must have it by itself.
set -euo pipefail
here=$(realpath "$(dirname "$0")")
if [ "${1:-}" != --in-display ]; then
  exec xvfb-run --auto-servernum --server-args '-screen 0 1280x800x24 -noreset' bash "$0" --in-display "$@"
fi
volume=$2 picture=$3 plugin=${4:-}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$volume" "$work/volume.vti"
steps=("$here/mid_surface.xml")
if [ -n "$plugin" ]; then
  cp "$plugin" "$work/MidSurface.so"
  steps=("$here/load_plugin.xml" "${steps[@]}")
fi
# One script: ParaView shows a message, in the way of the picture, at the end of each.
{
  echo '<pqevents>'
  grep -h '<pqevent ' "${steps[@]}"
  echo '</pqevents>'
} >"$work/steps.xml"

# Own settings, so that nobody's are read or changed.
export HOME=$work XDG_RUNTIME_DIR=$work LIBGL_ALWAYS_SOFTWARE=1
timeout 240 paraview --dr --test-directory="$work" --test-script="$work/steps.xml" --exit \
  >"$work/log" 2>&1 &
window=$!
# A step that fails leaves its dialog open: end it instead of waiting.
while kill -0 $window 2>/dev/null && [ ! -s "$work/state.pvsm" ]; do
  ! grep -q '^critical' "$work/log" || kill $window 2>/dev/null || true
  sleep 0.5
done
sleep 2
import -window root "$picture"
wait $window || {
  cat "$work/log"
  echo "failed: not every step could be taken in ParaView's window; see $picture" >&2
  exit 1
}
grep -q 'type="MidSurface"' "$work/state.pvsm"
pvpython "$here/check_picture.py" "$picture"
