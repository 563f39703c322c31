#!/bin/sh
# Fails where the plugin ($1) shows the process that loads it more than its entry points: two copies
# of the core, or two classes of one name, would clash.
symbols=$(nm --dynamic --defined-only --format=posix "$1") || exit 1
echo "$symbols" | grep -q '^pv_plugin_instance ' || {
  echo "$1 has no entry point for ParaView"
  exit 1
}
if echo "$symbols" | grep -E '^(midsurface|rust|_R)|FilterRun|LabelSelection|SegmentationVolume|^_ZN[A-Z]*[0-9]*vtkMid'; then
  echo "above: symbols that should stay inside $1"
  exit 1
fi
