#!/usr/bin/env bash
# Runs the README's commands on a bare Debian: cmake/check_distribution.sh SUITE [COMPILER [STEP...]]
#   SUITE     bookworm or trixie
#   COMPILER  gcc (the default), or clang: the newest that the suite has
#   STEP      demo; quick: cmake/test.sh; all: cmake/test.sh --all; unit: builds everything, runs the unit tests.
#             Without any: demo quick
# Needs root and debootstrap. The roots stay in ROOTS (default build/distributions), so that a second run of a suite
# begins with its packages. Prints how long each step took; the exit code is 0 if all passed. Compilers warn as errors.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

refuse() {
  echo "check_distribution.sh: $1" >&2
  exit 2
}

suite=${1:-} compiler=${2:-gcc}
steps=("${@:3}")
[ ${#steps[@]} -gt 0 ] || steps=(demo quick)
case $suite in bookworm | trixie) ;; *) refuse "found suite '$suite'; allowed are bookworm and trixie" ;; esac
case $compiler in gcc | clang) ;; *) refuse "found compiler '$compiler'; allowed are gcc and clang" ;; esac
for step in "${steps[@]}"; do
  case $step in demo | quick | all | unit) ;; *) refuse "found step '$step'; allowed are demo, quick, all and unit" ;; esac
done
[ "$(id -u)" = 0 ] || refuse "needs root"
command -v debootstrap >/dev/null || refuse "needs the package debootstrap"

roots=${ROOTS:-build/distributions}
mkdir -p "$roots"
root=$(realpath "$roots")/$suite
checkout=/sunbeam-$compiler
settings=(HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive
  CXXFLAGS=-Werror SUNBEAM_NEEDS_SLURM=1)

in_root() { chroot "$root" env -i "${settings[@]}" "$@"; }

times=()
# timed NAME COMMAND...: remembers how long the command took.
timed() {
  local start=$SECONDS
  "${@:2}"
  times+=("$(printf '%-8s %2d min %02d s' "$1" $(((SECONDS - start) / 60)) $(((SECONDS - start) % 60)))")
}

unmount() {
  local place
  for place in "$root/dev" "$root/proc" "$root/sys" "$root"; do
    if mountpoint -q "$place"; then umount -R -l "$place"; fi
  done
}

# A bare system whose packages come from where the host's do.
make_root() {
  [ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase --include=ca-certificates "$suite" "$root"
  cp /etc/apt/apt.conf.d/*proxy* /etc/apt/apt.conf.d/99* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  trap unmount EXIT
  # Slurm's test makes namespaces, which want a root that is mounted, and looks for control groups.
  mount --bind "$root" "$root"
  mount --rbind --make-rslave /sys "$root/sys"
  mount --bind /dev "$root/dev"
  mount -t proc proc "$root/proc"
  in_root apt-get update -q
  in_root apt-get install -q -y --no-install-recommends git
  rm -rf "${root:?}$checkout"
  git clone -q . "$root$checkout"
}

choose_compiler() {
  [ "$compiler" = clang ] || return 0
  local newest
  newest=$(in_root apt-cache search --names-only '^clang-[0-9]+$' | cut -d' ' -f1 | sort -t- -k2n | tail -n 1)
  in_root apt-get install -q -y --no-install-recommends "$newest"
  settings+=("CXX=${newest/clang/clang++}")
}

run_step() {
  case $1 in
    demo) in_root bash "$checkout/cmake/demo.sh" ;;
    quick) in_root bash "$checkout/cmake/test.sh" ;;
    all) in_root bash "$checkout/cmake/test.sh" --all ;;
    unit) in_root bash "$checkout/cmake/test.sh" --label unit ;;
  esac
}

timed system make_root
choose_compiler
for step in "${steps[@]}"; do timed "$step" run_step "$step"; done

printf '\n== Debian %s, %s\n' "$(cat "$root/etc/debian_version")" \
  "$(in_root bash -c '"${CXX:-g++}" --version | head -n 1')"
printf '%s\n' "${times[@]}"
