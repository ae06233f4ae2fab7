#!/usr/bin/env bash
# Remakes every table and plot of docs/accuracy.md, in about an hour on two cores:
#   scripts/accuracy.sh [SEED]
# The machine has to be quiet for the times in work-precision.md; nothing else depends on it.
set -euo pipefail
cd "$(dirname "$0")/.."
seed="${1:-1}"
to=docs/measured

# What misses a bar says so and fails; the other pages are made all the same.
missed=0
measure() { cargo run --release --quiet -p touchoff-tests --bin "$@" || missed=1; }

# A real part and its program, where they are there.
parts=../shared/data
own=()
if [ -e "$parts/parts/impeller.stl" ]; then
    own=(--part "$parts/parts/impeller.stl" --unit mm --tool D2Ball --path "$parts/paths/impeller_flank.apt")
fi
cargo run --release --quiet --features peers -- bench --seed "$seed" --scene all "${own[@]}" --out "$to" > /dev/null
measure accuracy -- 1000000 > "$to/accuracy.md"
measure stress -- --seed "$seed" > "$to/stress.md"
measure search -- --seed "$seed" > "$to/search.md"
measure continuity -- --seed "$seed" --to "$to"
measure convergence -- --seed "$seed" --to "$to"
exit "$missed"
