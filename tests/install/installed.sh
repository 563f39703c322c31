# To be sourced by the tests of `cmake --install`. Gives each a folder of its own, `work`, and the
# repository's root, `source`.
set -euo pipefail
source=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# install_component BUILD COMPONENT...: into $work/prefix, which is not where CMake was told.
install_components() {
  local build=$1 component
  shift
  for component in "$@"; do
    cmake --install "$build" --component "$component" --prefix "$work/prefix" >/dev/null
  done
}

# expect_files NAME...: fails unless these and no others, by their paths, were installed.
expect_files() {
  diff <(printf '%s\n' "$@" | sort) <(cd "$work/prefix" && find . ! -type d -printf '%P\n' | sort) || {
    echo "above: < missing, > installed but should not be"
    exit 1
  }
}
