# What demo.sh and test.sh share: installing what a build needs on Debian 12, and the build.
# To be sourced by a script with `set -euo pipefail`, from the repository's root.

# The oldest Rust that builds this; Cargo.toml says so too.
rust_needed=1.85

# ParaView, and what its CMake package looks for beside itself.
build_packages=(
  ca-certificates cmake g++ ninja-build paraview paraview-dev python3-paraview python3-numpy
  qtbase5-dev qttools5-dev libqt5svg5-dev libqt5opengl5-dev libqt5x11extras5-dev
  qtxmlpatterns5-dev-tools libutfcpp-dev libgl-dev libglew-dev libboost-dev mpi-default-dev
  libxml2-dev libprotobuf-dev protobuf-compiler libhdf5-openmpi-dev libnetcdf-dev libpython3-dev
  libdouble-conversion-dev liblz4-dev liblzma-dev libjpeg-dev libpng-dev libtiff-dev zlib1g-dev
  libexpat1-dev libfreetype-dev libeigen3-dev nlohmann-json3-dev libjsoncpp-dev libtheora-dev
  libogg-dev libgl2ps-dev libproj-dev libgdal-dev libavcodec-dev libavformat-dev libavutil-dev
  libswscale-dev libpugixml-dev libcgns-dev
)
# A display for machines without one, and software rendering.
display_packages=(xvfb xauth libgl1-mesa-dri)

say() { printf '\n== %s\n' "$*"; }

fail() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    fail "these packages are missing; as root, run: $*"
  fi
}

is_installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# Installs those of the packages named that are not there yet.
install_packages() {
  local package missing=()
  for package in "$@"; do
    is_installed "$package" || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  command -v apt-get >/dev/null ||
    fail "these scripts install with apt-get (Debian 12); elsewhere, install by hand: ${missing[*]}"
  say "Installing ${#missing[@]} packages"
  as_root apt-get update -qq
  as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null ||
    fail "apt-get could not install: ${missing[*]}"
}

rust_is_recent() {
  local tool version
  for tool in cargo rustc; do
    version=$("$tool" --version 2>/dev/null | cut -d ' ' -f 2) || return 1
    [ "$(printf '%s\n' "$rust_needed" "$version" | sort -V | head -n 1)" = "$rust_needed" ] ||
      return 1
  done
}

# Rust from Debian where the PATH has none that is recent enough.
install_rust() {
  [ -d "$HOME/.cargo/bin" ] && PATH="$PATH:$HOME/.cargo/bin"
  rust_is_recent && return
  install_packages rustc-web cargo-web
  # An older Rust that comes earlier on the PATH must not win.
  PATH="/usr/bin:$PATH"
  hash -r
  rust_is_recent || fail "Rust $rust_needed or later is needed, but $(cargo --version) was found"
}

# One target folder for CMake and for cargo called by hand, so that nothing is built twice.
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/build/cargo}"

# configure FOLDER OPTION...: once; later, the build configures again by itself where it must.
configure() {
  local folder=$1
  shift
  [ ! -f "$folder/build.ninja" ] || return 0
  mkdir -p "$folder"
  # Libraries where Debian has them.
  cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_INSTALL_LIBDIR="lib/$(gcc -print-multiarch)" "$@" >"$folder/configure.log" 2>&1 || {
    cat "$folder/configure.log" >&2
    fail "CMake could not configure"
  }
}

# Builds what is out of date, into build/. Sets `plugin`, the file to load.
build_all() {
  say "Building into build/"
  configure build
  cmake --build build || fail "the build failed"
  plugin=$(find "$PWD/build/lib" -name MidSurface.so | head -n 1)
  [ -n "$plugin" ] || fail "the build made no MidSurface.so"
}

# Runs a command with a display that nobody sees. Without -noreset the display starts anew when its
# last window closes, and refuses those that come meanwhile.
with_display() {
  xvfb-run --auto-servernum --server-args '-screen 0 1600x1200x24 -noreset' "$@"
}
