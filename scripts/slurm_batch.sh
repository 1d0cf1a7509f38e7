#!/usr/bin/env bash
# Runs a batch on a cluster with Slurm: an array of jobs, one per shard, and one that joins their
# summaries when all have ended.
#
# usage: scripts/slurm_batch.sh JOBS.json SHARDS [options of sbatch for the shards]
#   scripts/slurm_batch.sh jobs.json 16 --cpus-per-task=8 --mem=16G --time=2:00:00
#
# Prints the numbers of the two Slurm jobs. What is done already is not done again, so after a time
# limit or a node that failed the same command goes on. implicit-geodesic is looked for in PATH, or
# named by the variable IMPLICIT_GEODESIC.

set -euo pipefail

program=${IMPLICIT_GEODESIC:-implicit-geodesic}

# What a Slurm job runs: this script again, of which Slurm keeps a copy.
case ${1:-} in
    --shard)
        exec "$program" batch "$2" --threads "${SLURM_CPUS_PER_TASK:-1}" \
            --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
        ;;
    --merge)
        # A dot that begins a name begins no ending.
        name=$(basename "$2") stem=${name%.*}
        summary=$(dirname "$2")/${stem:-$name}.summary
        parts=()
        for ((k = 1; k <= $3; ++k)); do
            parts+=("$summary-$k-of-$3.json")
        done
        exec "$program" batch merge "${parts[@]}" -o "$summary.json"
        ;;
esac

if [[ $# -lt 2 || ! $2 =~ ^[1-9][0-9]*$ || $2 -lt 2 ]]; then
    sed -n '2,/^$/s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
jobs=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
shards=$2
shift 2

# Refusals belong here, not into the logs of the tasks.
"$program" batch "$jobs" --shard "1/$shards" --dry-run >/dev/null

array=$(sbatch --parsable --job-name=geodesics --array="1-$shards" "$@" "$0" --shard "$jobs")
array=${array%%;*}
# Also after failures: what is missing is then in its log.
merge=$(sbatch --parsable --job-name=geodesics-merge --dependency="afterany:$array" \
    "$0" --merge "$jobs" "$shards")
echo "shards: $array, merge: ${merge%%;*}"
