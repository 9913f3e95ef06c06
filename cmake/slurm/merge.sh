#!/bin/sh
# The last job of bake.sh: merge.sh OUTPUT. The parts go once the table is there and within its tolerances.
set -eu
"${SUNBEAM:-sunbeam}" merge "$1.parts"/*.part -o "$1" --threads "$SLURM_CPUS_ON_NODE" --progress json
rm "$1.parts"/*.part
