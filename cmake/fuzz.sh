#!/usr/bin/env bash
# Builds the fuzzing targets of tests/fuzz and runs them; tests/README.md says more.
source "$(dirname "$0")/setup.sh"

usage="usage: bash cmake/fuzz.sh TIME [NAME...]
  TIME   for each target: 5s, 10m, 2h
  NAME   targets, all by default: table_exr, obj, ..."
[[ ${1:-} =~ ^([1-9][0-9]*)([smh])$ ]] || { printf '%s\n' "$usage" >&2; exit 2; }
declare -A unit=([s]=1 [m]=60 [h]=3600)
seconds=$((BASH_REMATCH[1] * unit[${BASH_REMATCH[2]}]))
shift

install_packages "${packages[@]}" clang-16 libclang-rt-16-dev
build fuzz
[ $# -gt 0 ] || set -- $(cd tests/fuzz && printf '%s\n' *_fuzz.cpp | sed 's/_fuzz.cpp$//')

results=build/fuzz/results
mkdir -p "$results"

# The corpus grows in the build folder; what is found goes to build/fuzz/results/NAME-*.
run() {
  local name=$1 folder inputs=()
  for folder in build/fuzz/corpus tests/fuzz/seeds tests/fuzz/findings; do
    [ ! -d "$folder/$name" ] || inputs+=("$folder/$name")
  done
  build/fuzz/bin/fuzz_"$name" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2560 -malloc_limit_mb=1000 \
    -print_final_stats=1 -artifact_prefix="$results/$name-" "${inputs[@]}" >"$results/$name.log" 2>&1
}
export -f run
export seconds results

say "Fuzzing $# targets for $seconds s each, $(nproc) at a time"
for name in "$@"; do
  [ -x "build/fuzz/bin/fuzz_$name" ] || { echo "$0: no target '$name'" >&2; exit 2; }
  mkdir -p "build/fuzz/corpus/$name"
  rm -f "$results/$name"-* "$results/$name.log"
done
printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} bash -c 'run {} || touch "$results/{}-failed"'

say "Summary"
failed=0
for name in "$@"; do
  executions=$(sed -n 's/^stat::number_of_executed_units: //p' "$results/$name.log")
  verdict=passed
  if [ -e "$results/$name-failed" ]; then
    verdict=FAILED failed=1
    grep -m1 -E '^SUMMARY|ERROR: libFuzzer' "$results/$name.log" || tail -3 "$results/$name.log"
  fi
  printf '%-12s %10s inputs  %s\n' "$name" "${executions:-none}" "$verdict"
done
exit $failed
