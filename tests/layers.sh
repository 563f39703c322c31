#!/bin/sh
# Fails where a layer knows what it must not. The core is plain Rust: no host application, no foreign
# interface, nothing unsafe. Within it data flows one way: no folder uses what comes after it. The filters
# are wrappers: no file access, no threads of their own.
cd "$(dirname "$0")/.." || exit 1
status=0

# forbid PATTERN REASON PATH...
forbid() {
  pattern=$1
  reason=$2
  shift 2
  for path in "$@"; do
    if [ ! -e "$path" ]; then
      echo "missing: $path"
      status=1
    fi
  done
  if grep -rnE "$pattern" "$@"; then
    echo "above: $reason"
    status=1
  fi
}

core=rust/midsurface/src
forbid '[Vv][Tt][Kk]|[Pp]ara[Vv]iew' 'the core names its host' rust/midsurface
forbid '(^|[^_a-z])unsafe([^_a-z]|$)|extern "C"|no_mangle' \
  'the core has a foreign interface or unsafe code' $core
forbid 'std::(fs|net)|(^|[^a-z])e?print(ln)?!' 'the core reads, writes or prints' $core
# From the end of the way to its beginning.
later=extraction
for stage in tiles zipper ridge_surface.rs finish remesh midway contour sheets surface fields reading; do
  forbid "crate::($later)([^_a-z]|\$)" 'a stage of the core uses a later one' $core/$stage
  later="$later|${stage%.rs}"
done
forbid 'std::(thread|async|fstream|ifstream|ofstream)|vtkSMPTools' \
  'a filter does work that belongs into the core' plugin
# VTK's wrapping tools read these headers, and programs that use the filters include them.
forbid 'include .midsurface' 'a class header includes the C interface' plugin/filters/vtk*.h
exit $status
