# Sourced by demo.sh, test.sh and .ci/run: installs what is missing on Debian 12 or 13, and builds. Safe to repeat.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

packages=(g++ cmake ninja-build ccache git python3
  libopenexr-dev libimath-dev libopenvdb-dev libembree-dev libtbb-dev libboost-iostreams-dev zlib1g-dev libpng-dev
  libcli11-dev libfmt-dev libtomlplusplus-dev nlohmann-json3-dev libxxhash-dev)
test_packages=(pkg-config libgtest-dev libgmock-dev libbenchmark-dev openexr libopenvdb-tools
  slurmctld slurmd slurm-client munge)

say() { printf '\n== %s\n' "$*"; }

# install_packages NAME...: installs those that are not there yet.
install_packages() {
  local missing=() as_root=() name
  for name in "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || missing+=("$name")
  done
  if [ ${#missing[@]} = 0 ]; then
    say "All packages are installed"
    return
  fi
  [ "$(id -u)" = 0 ] || as_root=(sudo)
  if [ ${#as_root[@]} != 0 ] && ! command -v sudo >/dev/null; then
    say "Neither root nor sudo to install these ${#missing[@]} packages; going on without: ${missing[*]}"
    return
  fi
  say "Installing ${#missing[@]} packages: ${missing[*]}"
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# build PRESET [CMAKE-OPTION...]: CXX in the environment chooses the compiler.
build() {
  local preset=$1 fresh=() before
  shift
  # CMake keeps the compiler that a build folder began with.
  before=$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' "build/$preset/CMakeCache.txt" 2>/dev/null || true)
  if [ -n "${CXX:-}" ] && [ -n "$before" ] && [ "$(readlink -f "$(command -v "${CXX%% *}")")" != "$(readlink -f "$before")" ]; then
    say "build/$preset was made with $before, not $CXX: starting anew"
    fresh=(--fresh)
  fi
  say "Building (preset $preset)"
  cmake --preset "$preset" "${fresh[@]}" "$@"
  cmake --build --preset "$preset" -j "$(nproc)"
}
