# Sourced by demo.sh and test.sh: installs what is missing on Debian 12 and builds. Safe to repeat.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

packages=(g++ cmake ninja-build ccache git python3
  libopenexr-dev libimath-dev libopenvdb-dev libembree-dev libtbb-dev libboost-iostreams-dev zlib1g-dev libpng-dev
  libcli11-dev libfmt-dev libtomlplusplus-dev nlohmann-json3-dev libxxhash-dev libtinyobjloader-dev)
test_packages=(libgtest-dev libgmock-dev libbenchmark-dev clang-format openexr libopenvdb-tools
  slurmctld slurmd slurm-client munge)

say() { printf '\n== %s\n' "$*"; }

as_root() { if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi; }

# install_packages NAME...: installs those that are not there yet.
install_packages() {
  local missing=() name
  for name in "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || missing+=("$name")
  done
  if [ ${#missing[@]} = 0 ]; then
    say "All packages are installed"
    return
  fi
  say "Installing ${#missing[@]} packages: ${missing[*]}"
  as_root apt-get update -q
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# build PRESET [CMAKE-OPTION...]
build() {
  local preset=$1
  shift
  say "Building (preset $preset)"
  cmake --preset "$preset" "$@"
  cmake --build --preset "$preset" -j "$(nproc)"
}
