#!/bin/sh
# Bakes a recipe on a Slurm cluster: an array of N jobs bakes a part each, a last job merges them into OUTPUT.
#   SBATCH_OPTIONS="--partition=cpu --cpus-per-task=16" sh cmake/slurm/bake.sh RECIPE N OUTPUT [BAKE-OPTION...]
# Every node must see RECIPE, OUTPUT and sunbeam (on the PATH, or named by SUNBEAM) at the same place. Parts and
# logs are in OUTPUT.parts. What has failed goes on where it was if the same command is given again.
set -eu
[ $# -ge 3 ] || { echo "usage: $0 RECIPE N OUTPUT [BAKE-OPTION...]" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
# No name begins with a dash then.
absolute() {
  case $1 in /*) printf '%s\n' "$1" ;; *) printf '%s/%s\n' "$PWD" "$1" ;; esac
}
recipe=$(absolute "$1") count=$2 output=$(absolute "$3")
shift 3
# Slurm expands % in the names of logs, and none of them where there is a backslash.
case $output in
  *\\*) echo "$0: $output: a name with a backslash; Slurm allows none in names of logs" >&2; exit 2 ;;
esac
logs=$(printf '%s\n' "$output.parts" | sed 's/%/%%/g')
mkdir -p "$output.parts"

# shellcheck disable=SC2086  # options are words
array=$(sbatch --parsable ${SBATCH_OPTIONS-} --job-name=sunbeam-bake --array="1-$count" --requeue \
  --open-mode=append --output="$logs/%a.log" "$here/part.sh" "$recipe" "$count" "$output" "$@")
# shellcheck disable=SC2086
merge=$(sbatch --parsable ${SBATCH_OPTIONS-} --job-name=sunbeam-merge --dependency="afterok:${array%%;*}" \
  --kill-on-invalid-dep=yes --output="$logs/merge.log" "$here/merge.sh" "$output")
echo "array ${array%%;*}, merge ${merge%%;*}"
