#!/usr/bin/env bash
# Builds the Debian packages, into build/packages/: of the plugin for ParaView, of the library for
# VTK 9.1, of its Python package and of the C library.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/build.sh
. scripts/vtk9.sh

install_packages "${build_packages[@]}" dpkg-dev file
install_rust
build_all
build_vtk9

say "Packing"
rm -rf build/packages
for folder in build build/vtk9; do
  cpack -G DEB --config "$folder/CPackConfig.cmake" -B "$PWD/build/packages" || fail "cpack failed"
done
rm -r build/packages/_CPack_Packages
ls -l build/packages
