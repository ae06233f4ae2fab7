#!/usr/bin/env bash
# Remakes every table and plot of docs/accuracy.md, in about an hour on two cores:
#   scripts/accuracy.sh [SEED]
# The machine has to be quiet for the times in work-precision.md; nothing else depends on it.
set -euo pipefail
cd "$(dirname "$0")/.."
seed="${1:-1}"

# What misses a bar says so and fails; the other pages are made all the same.
missed=0
measure() { cargo run --release --quiet -p touchoff-bench -- "$@" || missed=1; }

# A real part and its program, where they are there.
parts=../shared/data
own=()
if [ -e "$parts/parts/impeller.stl" ]; then
    own=(--part "$parts/parts/impeller.stl" --unit mm --tool D2Ball --path "$parts/paths/impeller_flank.apt")
fi
cargo run --release --quiet -p touchoff-bench --features peers -- work-precision --seed "$seed" --scene all "${own[@]}" > /dev/null
measure accuracy
measure stress --seed "$seed"
measure search --seed "$seed"
measure continuity --seed "$seed"
measure convergence --seed "$seed"
exit "$missed"
