#!/usr/bin/env bash
# From a bare Debian 12 or 13 to a passed test suite; tests/README.md says what there is.
source "$(dirname "$0")/setup.sh"

labels="unit portable statistical accuracy render cli bench long"
usage="usage: bash cmake/test.sh [--all | --label NAME] [-DNAME=VALUE...]
  (nothing)     every test but those labelled long: about 15 minutes from bare on two idle cores
  --all         every test: a minute or two more
  --label NAME  those of one label: $labels
  -DNAME=VALUE  for CMake, -DSUNBEAM_WERROR=ON for example"
refuse() {
  printf '%s: %s\n%s\n' "$0" "$1" "$usage" >&2
  exit 2
}

filter=(-LE '^long$') options=() chosen=
takes="every test but the long ones: about 15 minutes from bare on two idle cores"
choose() {
  [ -z "$chosen" ] || refuse "--all and --label go once and alone"
  chosen=$1
}
while [ $# -gt 0 ]; do
  case $1 in
    --all)
      choose --all
      filter=() takes="every test: about 17 minutes from bare on two idle cores" ;;
    --label)
      choose --label
      [[ ${2:-} =~ ^[a-z]+$ && " $labels " = *" $2 "* ]] || refuse "--label needs one of: $labels"
      filter=(-L "^$2\$") takes="the tests labelled $2: the build alone takes about 8 minutes from bare on two idle cores"
      shift ;;
    -h | --help)
      echo "$usage"
      exit ;;
    -D?*) options+=("$1") ;;
    *) refuse "unknown argument '$1'" ;;
  esac
  shift
done

say "Building and running $takes"
echo "Needs, besides what the tool is built with: GoogleTest and Google Benchmark; openexr and libopenvdb-tools, whose own
programs read our files; and slurmctld, slurmd, slurm-client and munge, which make a cluster of this one machine to
run cmake/slurm/bake.sh on, for the time of that test (without them, or not as root, it is skipped)."
install_packages "${packages[@]}" "${test_packages[@]}"
build release -DSUNBEAM_BUILD_TESTS=ON "${options[@]}"

say "Running the tests"
log=build/release/tests.log
status=0
ctest --test-dir build/release "${filter[@]}" -j "$(nproc)" --output-on-failure --no-tests=error 2>&1 | tee "$log" || status=$?
grep -h "skipped 'Slurm" build/release/Testing/Temporary/LastTest.log || true

say "The ten slowest"
sed -nE 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([^ ]+) .* ([0-9.]+) sec.*/\2 s  \1/p' "$log" | sort -rn | sed -n 1,10p

say "Summary"
sed -n '/tests passed, .* failed out of/,$p' "$log"
exit $status
