#!/bin/sh
# sbatch --array=0-3 --wait slurm.sh runs.csv campaign; dropcheck merge campaign/results-*-of-4.jsonl --out campaign
# All nodes see the recordings, the manifest and the folder. A part that was stopped goes on when it is submitted again.
#SBATCH --cpus-per-task=1
#SBATCH --mem=500M
dropcheck batch --manifest "$1" --out "$2" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" \
    --jobs "${SLURM_CPUS_PER_TASK:-1}" --resume
