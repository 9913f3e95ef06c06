#!/usr/bin/env bash
# The runtime on 64-bit Arm without such a machine: cross-compiled, its tests run under qemu, and its look-ups
# compared with those of this machine, which must be x86-64. Run: bash cmake/check_arm.sh
#
# It needs Debian 12 with g++-aarch64-linux-gnu, qemu-user and what cmake/test.sh installs, and the network: the
# libraries for Arm are downloaded and unpacked below build/arm; nothing is installed. On two busy cores it takes
# a quarter of an hour from nothing, and half of that again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf '\n== %s\n' "$*"; }

# An apt of its own, so that the machine's knows nothing of another architecture.
fetch() (
  mkdir -p build/arm/apt/lists/partial build/arm/apt/archives/partial build/arm/debs
  options=(-q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User="$(id -un)"
    -o Dir::State::lists="$PWD/build/arm/apt/lists" -o Dir::State::status=/dev/null
    -o Dir::Cache="$PWD/build/arm/apt" -o Acquire::Languages=none)
  cd build/arm/debs
  apt-get "${options[@]}" update
  apt-get "${options[@]}" download "$@"
)

if [ ! -d build/arm/sysroot ]; then
  say "Downloading libraries for Arm"
  fetch libopenexr-dev libopenexr-3-1-30 libimath-dev libimath-3-1-29 zlib1g-dev zlib1g libxxhash-dev \
    libgtest-dev libgmock-dev googletest
  for package in build/arm/debs/*.deb; do dpkg -x "$package" build/arm/unpacked; done
  mv build/arm/unpacked build/arm/sysroot
fi

options=(-DSUNBEAM_BUILD_TRACER=OFF -DSUNBEAM_BUILD_VDB=OFF -DSUNBEAM_BUILD_BAKE=OFF -DSUNBEAM_WERROR=ON)

say "Building for this machine"
cmake -S . -B build/arm/host -G Ninja "${options[@]}"
cmake --build build/arm/host --target lookups_fast

say "Building for Arm, with vectors and without"
cmake -S . -B build/arm/release -G Ninja --toolchain cmake/aarch64.cmake "${options[@]}"
cmake --build build/arm/release

say "Running the tests under qemu, without quadratures of minutes"
ctest --test-dir build/arm/release -j "$(nproc)" --output-on-failure --no-tests=error \
  -E 'AddUpToOne|AlbedoThreeWays|IntegratesToOneMinusWhatIsLost'

say "Comparing look-ups with those of this machine"
compare() { python3 tests/portable/lookups_test.py compare "$@"; }
libraries=build/arm/sysroot/usr/lib/aarch64-linux-gnu:build/arm/sysroot/lib/aarch64-linux-gnu
SUNBEAM_KERNELS=baseline build/arm/host/bin/lookups_fast >build/arm/host.txt
for kind in fast portable; do
  qemu-aarch64 -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH="$libraries" \
    "build/arm/release/bin/lookups_$kind" >"build/arm/$kind.txt"
  compare build/arm/host.txt "build/arm/$kind.txt"
done
