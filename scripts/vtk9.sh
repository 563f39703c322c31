# VTK 9.1, Debian 12's own, to build the library for VTK against. Its development package excludes
# python3-paraview, so it is unpacked into build/vtk9-root instead of installed.
# To be sourced after build.sh, from the repository's root.

# Sets `vtk9_root`.
unpack_vtk9() {
  vtk9_root=$PWD/build/vtk9-root
  # What its libraries and its CMake package look for.
  install_packages libvtk9.1 libtbb-dev
  local version
  version=$(dpkg-query -W -f='${Version}' libvtk9.1)
  [ "$(cat "$vtk9_root/version" 2>/dev/null)" = "$version" ] && return
  say "Unpacking VTK $version beside the system"
  rm -rf "$vtk9_root"
  mkdir -p "$vtk9_root/packages"
  (
    cd "$vtk9_root/packages"
    apt-get download -qq "libvtk9.1=$version" "libvtk9-dev=$version" "vtk9=$version" \
      "python3-vtk9=$version" 2>/dev/null || fail "apt-get could not download libvtk9-dev"
    for package in *.deb; do
      dpkg -x "$package" "$vtk9_root"
    done
  )
  rm -r "$vtk9_root/packages"
  echo "$version" >"$vtk9_root/version"
}

# Builds the library for VTK, its Python package and their tests, into build/vtk9/.
build_vtk9() {
  unpack_vtk9
  say "Building for VTK 9.1 into build/vtk9/"
  configure build/vtk9 -DMIDSURFACE_BUILD_PARAVIEW_PLUGIN=OFF \
    -DVTK_DIR="$(dirname "$(find "$vtk9_root" -name vtk-config.cmake)")" \
    -DPython3_EXECUTABLE=/usr/bin/python3
  cmake --build build/vtk9 || fail "the build for VTK 9.1 failed"
}
