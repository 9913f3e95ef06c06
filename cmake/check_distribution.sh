#!/usr/bin/env bash
# Runs the README's two commands on a bare Debian: cmake/check_distribution.sh SUITE [COMPILER] [STEP...]
#   SUITE     bookworm or trixie
#   COMPILER  gcc (the default) or clang: the newest packaged one
#   STEP      demo, quick, all, unit (build everything, run the unit tests); the default is demo quick
# Needs root and debootstrap. ROOTS=folder keeps the roots there (default build/distributions): the next run
# of the same suite begins with its packages. It prints the time of every step; the exit code is 0 if all passed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
  sed -n '2,7s/^# //p' "$0" >&2
  exit 2
}

[ $# -ge 1 ] || usage
suite=$1 compiler=${2:-gcc}
shift $(($# < 2 ? $# : 2))
steps=("$@")
[ ${#steps[@]} -gt 0 ] || steps=(demo quick)
case $suite in bookworm | trixie) ;; *) usage ;; esac
case $compiler in gcc | clang) ;; *) usage ;; esac
for step in "${steps[@]}"; do
  case $step in demo | quick | all | unit) ;; *) usage ;; esac
done
if [ "$(id -u)" != 0 ] || ! command -v debootstrap >/dev/null; then
  echo "check_distribution.sh: needs root and debootstrap" >&2
  exit 2
fi

checkout=$PWD
roots=${ROOTS:-build/distributions}
mkdir -p "$roots"
root=$(realpath "$roots")/$suite

in_root() { chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 CI="${CI:-}" "$@"; }

# timed NAME COMMAND...: says how long the command took.
timed() {
  local name=$1 start=$SECONDS
  shift
  "$@"
  times+="$(printf '%-28s %d min %02d s' "$name" $(((SECONDS - start) / 60)) $(((SECONDS - start) % 60)))"$'\n'
}

unmount() {
  local place
  for place in dev/shm dev proc; do
    if mountpoint -q "$root/$place"; then umount -l "$root/$place"; fi
  done
}

# A bare system with the host's package sources, moved to this suite.
make_root() {
  [ -e "$root/etc/debian_version" ] ||
    debootstrap --variant=minbase --include=ca-certificates "$suite" "$root"
  rm -rf "$root/etc/apt"
  cp -r /etc/apt "$root/etc/apt"
  rm -f "$root/etc/apt/sources.list" "$root"/etc/apt/sources.list.d/* "$root"/etc/apt/preferences.d/*
  local mirror
  mirror=$(grep -hoE 'https?://[^ ]*/debian/? ' /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
    head -n 1 || true)
  echo "deb ${mirror:-http://deb.debian.org/debian} $suite main" >"$root/etc/apt/sources.list"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
}

trap unmount EXIT
times=""
timed "system" make_root
mount --bind /dev "$root/dev"
mount -t proc proc "$root/proc"

in_root apt-get update -q >/dev/null
in_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends git >/dev/null
rm -rf "$root/sunbeam"
git clone -q "$checkout" "$root/sunbeam"

settings=()
if [ "$compiler" = clang ]; then
  # The newest that the suite has.
  clang=$(in_root apt-cache pkgnames clang- | grep -E '^clang-[0-9]+$' | sort -t- -k2n | tail -n 1)
  in_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "$clang" >/dev/null
  settings=(CXX="${clang/clang/clang++}")
fi

run_step() {
  case $1 in
    demo) in_root "${settings[@]}" bash /sunbeam/cmake/demo.sh ;;
    quick) in_root "${settings[@]}" bash /sunbeam/cmake/test.sh -DSUNBEAM_WERROR=ON ;;
    all) in_root "${settings[@]}" bash /sunbeam/cmake/test.sh --all -DSUNBEAM_WERROR=ON ;;
    unit) in_root "${settings[@]}" bash /sunbeam/cmake/test.sh --label unit -DSUNBEAM_WERROR=ON ;;
  esac
}
for step in "${steps[@]}"; do timed "$step" run_step "$step"; done

printf '\n== %s with %s, %s\n%s' "$suite" "$compiler" "$(in_root cat /etc/debian_version)" "$times"
