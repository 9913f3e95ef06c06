#!/bin/sh
# One job of the array of bake.sh: part.sh RECIPE N OUTPUT [BAKE-OPTION...]. A bake that fails is queued again, up
# to RESTARTS (3) times, and goes on with the blocks it has.
set -eu
recipe=$1 count=$2 output=$3
shift 3
code=0
"${SUNBEAM:-sunbeam}" bake "$recipe" --shard "$SLURM_ARRAY_TASK_ID/$count" -o "$output.parts/$SLURM_ARRAY_TASK_ID.part" \
  --resume --threads "$SLURM_CPUS_ON_NODE" --progress json "$@" || code=$?
if [ $code != 0 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt "${RESTARTS:-3}" ]; then
  echo "exit code $code: queued again"
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
  sleep 60 # until the requeue ends this run
fi
exit $code
