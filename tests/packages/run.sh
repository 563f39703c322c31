#!/usr/bin/env bash
# Installs the Debian packages in build/packages as a user does, tries them and removes them.
#
# All of it happens in a copy of this system that is thrown away: an overlay, which nothing outside
# sees. Where the kernel grants none, as in many containers, it happens on this system, and Python's
# part of ParaView, which the packages for VTK 9.1 push aside, is installed again at the end.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/build.sh

[ "$(find build/packages -name '*.deb' | wc -l)" = 5 ] || fail "scripts/packages.sh has not been run"
work=$(mktemp -d "$PWD/build/system.XXXXXX")
trap 'rm -rf "$work" || as_root rm -rf "$work"' EXIT
mkdir -p "$work/upper" "$work/work" "$work/root" "$work/files"
cp -r build/packages examples tests/packages/installed.sh tests/gui "$work/files"
cargo run --quiet --locked --release --package phantoms --bin make-sample -- \
  "$work/files/vesicle.vti" sphere --size 64 64 64

# Runs as root in a mount namespace of its own, so that nothing stays mounted.
in_overlay='
  set -e
  mount -t overlay overlay -o "lowerdir=/,upperdir=$1/upper,workdir=$1/work" "$1/root"
  [ "${2:-}" = try ] && exit
  mount --rbind /dev "$1/root/dev"
  mount --rbind /sys "$1/root/sys"
  mount -t proc proc "$1/root/proc"
  mount -t tmpfs tmpfs "$1/root/tmp"
  mkdir "$1/root/tmp/files"
  mount --bind "$1/files" "$1/root/tmp/files"
  cp --remove-destination -L /etc/resolv.conf "$1/root/etc/resolv.conf"
  exec chroot "$1/root" bash /tmp/files/installed.sh /tmp/files'

if as_root unshare --mount bash -c "$in_overlay" - "$work" try 2>/dev/null; then
  say "Trying the packages in a copy of this system"
  as_root unshare --mount --pid --fork bash -c "$in_overlay" - "$work"
else
  say "Trying the packages on this system: it grants no overlay"
  restore() {
    as_root apt-get purge -y -qq 'midsurface-paraview' 'libmidsurface*' 'python3-midsurface' ||
      true
    install_packages "${build_packages[@]}"
    rm -rf "$work"
  }
  trap restore EXIT
  as_root bash "$work/files/installed.sh" "$work/files"
fi
