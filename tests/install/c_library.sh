#!/usr/bin/env bash
# The C library as installed: examples/c outside the source tree, with what pkg-config says.
. "$(dirname "$0")/installed.sh"
install_components "$1" c_library
libraries=$(cd "$work/prefix" && dirname "$(find . -name 'libmidsurface_capi.a' -printf '%P\n')")
expect_files "$libraries/libmidsurface_capi.a" "$libraries/pkgconfig/midsurface.pc" \
  include/midsurface.h include/midsurface.hpp

# It can be moved as a whole.
mv "$work/prefix" "$work/moved"
cp "$source/examples/c/vesicle.c" "$work"
cd "$work"
export PKG_CONFIG_PATH=$work/moved/$libraries/pkgconfig
# Words on purpose: these are lists of flags.
# shellcheck disable=SC2046
cc -std=c11 -Wall -Wextra -Wpedantic -Werror vesicle.c $(pkg-config --cflags --libs midsurface) \
  -o vesicle
./vesicle vesicle.obj
awk '
  $1 == "v" {
    radius = sqrt(($2 - 23.5) ^ 2 + ($3 - 23.5) ^ 2 + ($4 - 23.5) ^ 2)
    if (radius < 16.2 || radius > 17.8) { print "off the middle: " $0; exit 1 }
  }
  $1 == "f" { ++triangles }
  END { if (triangles < 1000) { print triangles " triangles"; exit 1 } }' vesicle.obj
[ "$(pkg-config --modversion midsurface)" = "$(sed -n 's/^project(MidSurface VERSION \([^ ]*\) .*/\1/p' \
  "$source/CMakeLists.txt")" ]
