#!/usr/bin/env bash
# Do two builds make the same bits? bash cmake/same_bits.sh OLD NEW [--except ATTRIBUTE], of two sunbeam programs.
# It bakes small tables of every kind with both and compares them and what `eval` says. Exit code: 0 same, 1 not, 2 bad usage.
set -euo pipefail
exec env PYTHONDONTWRITEBYTECODE=1 python3 "$(dirname "${BASH_SOURCE[0]}")/../tests/same_bits/same_bits.py" "$@"
