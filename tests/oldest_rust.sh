#!/usr/bin/env bash
# The oldest Rust that Cargo.toml promises, Debian 12's rustc-web 1.85, checks all of the code.
# It is unpacked into build/rust-1.85, beside the Rust that is installed.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/build.sh
root=$PWD/build/rust-$rust_needed
if [ ! -x "$root/usr/bin/rustc" ]; then
  version=$(apt-cache madison rustc-web | awk -v v="$rust_needed" 'index($3, v) == 1 { print $3; exit }')
  [ -n "$version" ] || {
    echo "skipped: apt-get has no rustc-web $rust_needed"
    exit 0
  }
  say "Unpacking Rust $version beside the system"
  mkdir -p "$root/packages"
  (
    cd "$root/packages"
    apt-get download -qq "rustc-web=$version" "cargo-web=$version" "libstd-rust-web-dev=$version" \
      "libstd-rust-web-$rust_needed=$version" libllvm19 libhttp-parser2.9 libpcre3 2>/dev/null
    for package in *.deb; do
      dpkg -x "$package" "$root"
    done
  )
  rm -r "$root/packages"
fi
libraries=$(gcc -print-multiarch)
export LD_LIBRARY_PATH=$root/usr/lib/$libraries:$root/lib/$libraries:$root/usr/lib/llvm-19/lib
export PATH=$root/usr/bin:$PATH CARGO_TARGET_DIR=$CARGO_TARGET_DIR/oldest
rustc --version
cargo check --locked --quiet --workspace --all-targets
