#!/usr/bin/env bash
# The core's unit tests, panics in every stage and the fuzz targets under AddressSanitizer, for a
# bounded time.
#
#     sanitizers.sh [SECONDS]
#
# SECONDS: how long each fuzz target runs, 25 unless told. What it finds stays in fuzz/artifacts;
# `cargo fuzz run TARGET FILE`, where cargo-fuzz is installed, or the program that this script
# names, with the file, shows it again. C and C++ run under sanitizers in tests/c.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-25}
target=$(rustc --version --verbose | sed -n 's/^host: //p')
runtime=$(find "$(rustc --print sysroot)/lib/rustlib/$target" -name 'librustc*_rt.asan.a')
if [ -z "$runtime" ]; then
  echo "skipped: this Rust has no sanitizers (Debian's has none)"
  exit 0
fi
# The sanitizer is not stable in Rust.
export RUSTC_BOOTSTRAP=1
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/build/cargo}/sanitizers"
export CARGO_PROFILE_RELEASE_LTO=off ASAN_OPTIONS=detect_leaks=1
export LSAN_OPTIONS=suppressions=$PWD/fuzz/leaks.txt:print_suppressions=0

echo "-- The core's unit tests"
RUSTFLAGS="-Zsanitizer=address" cargo test --locked --quiet --release --target "$target" \
  -p midsurface --lib

echo "-- Panics in every stage"
RUSTFLAGS="-Zsanitizer=address" cargo test --locked --quiet --release --target "$target" \
  -p midsurface-capi --features inject-panics --lib stages_panic

echo "-- Fuzz targets, $seconds s each"
coverage="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4
  -Cllvm-args=-sanitizer-coverage-inline-8bit-counters
  -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares"
RUSTFLAGS="-Zsanitizer=address --cfg fuzzing -Ccodegen-units=1 $(echo $coverage)" \
  cargo build --locked --quiet --release --target "$target" --manifest-path fuzz/Cargo.toml
mkdir -p fuzz/artifacts
for name in volume volume_polylines volume_fields volume_pieces polylines triangles; do
  program=$CARGO_TARGET_DIR/$target/release/$name
  found=$(mktemp -d)
  echo "$program"
  # The folder named first gets what is new; the kept corpus, which all that take volumes share,
  # stays as it is.
  "$program" "$found" "fuzz/corpus/${name%%_*}" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=3000 \
    -max_len=600 -artifact_prefix=fuzz/artifacts/ -print_final_stats=1 >"$found.log" 2>&1 || {
    grep -a -v '^#' "$found.log"
    exit 1
  }
  grep -a 'number_of_executed_units' "$found.log"
  rm -rf "$found" "$found.log"
done
