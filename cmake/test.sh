#!/usr/bin/env bash
# From a bare Debian 12 to a passed test suite: bash cmake/test.sh [CMAKE-OPTION...]
source "$(dirname "$0")/setup.sh"

install_packages "${packages[@]}" "${test_packages[@]}"
build release -DSUNBEAM_BUILD_TESTS=ON "$@"

say "Running the tests"
ctest --test-dir build/release -j "$(nproc)" --output-on-failure --no-tests=error
grep -h "skipped 'Slurm" build/release/Testing/Temporary/LastTest.log || true
