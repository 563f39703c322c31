#!/usr/bin/env bash
# Installs, builds and runs every test. Fails at the first step that does not pass.
set -euo pipefail
cd "$(dirname "$0")"
. scripts/build.sh
. scripts/vtk9.sh

install_packages "${build_packages[@]}" "${display_packages[@]}" clang-format pkgconf dpkg-dev file \
  imagemagick
install_rust
# Where Rust came from Debian, its formatter does too; Debian has no clippy for it.
is_installed rustc-web && ! cargo fmt --version >/dev/null 2>&1 && install_packages rustfmt-web

say "Formatting"
cargo fmt --all --check
git ls-files '*.h' '*.hpp' '*.cxx' '*.c' | grep -v '/midsurface\.h$' |
  xargs --no-run-if-empty clang-format --dry-run --Werror

scripts/packages.sh
build_all

say "Rust: lints and documentation"
if cargo clippy --version >/dev/null 2>&1; then
  cargo clippy --locked --workspace --all-targets --release \
    --features midsurface-capi/inject-panics -- -D warnings
else
  echo "clippy is not installed: its lints are skipped"
fi
RUSTDOCFLAGS="-D warnings" cargo doc --locked --workspace --no-deps --release

say "Rust: tests"
cargo test --locked --workspace --release
say "Rust: panics in every stage"
cargo test --locked --release -p midsurface-capi --features inject-panics --lib stages_panic
say "Rust: sanitizers and fuzz targets"
tests/sanitizers.sh
say "Rust: the crates and the oldest version"
cargo metadata --format-version 1 --locked | python3 tests/licences.py
tests/oldest_rust.sh

say "C, C++ and pvpython: tests"
with_display ctest --test-dir build --output-on-failure
say "The library for VTK 9.1: tests"
ctest --test-dir build/vtk9 --output-on-failure

say "The packages, installed"
tests/packages/run.sh

say "Both commands from outside"
tests/demo/run.sh
