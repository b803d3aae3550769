#!/usr/bin/env bash
# CPU seconds of the targets of docs/performance.md, as ratios to an earlier commit that is built beside this one: the two
# programs take turns on every work, so that a machine that changes its speed changes both. Not on a busy machine.
# Usage: tests/baseline.sh [identify|batch|practice|real|practice/RECORD|real/RECORD]...   (all of them: hours)
set -euo pipefail
commit=789214f
cd "$(dirname "${BASH_SOURCE[0]}")/.."
top=$PWD
shared=${FCT_SHARED:-$top/../shared}
wanted=("$@")
[ ${#wanted[@]} -gt 0 ] || wanted=(identify batch practice real)

# The earlier commit in a folder of its own, under target/.
old=$top/target/baseline/source
if ! [ -d "$old" ]; then
    mkdir -p "$top/target/baseline"
    git worktree prune
    git worktree add --detach "$old" "$commit" >/dev/null
fi
(cd "$old" && CARGO_TARGET_DIR="$top/target/baseline/build" cargo build --release -q)
cargo build --release -q

# Copies, so that a build in the meantime changes nothing.
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
then_fct=$out/then now_fct=$out/now
cp "$top/target/baseline/build/release/fct" "$then_fct"
cp "${CARGO_TARGET_DIR:-$top/target}/release/fct" "$now_fct"

# `$1 COMMAND…` in a folder of its own: CPU seconds, user and system, children included, and what it answers. A command that
# fails is no measurement.
measured() {
    local TIMEFORMAT='%U %S' run
    run=$(mktemp -d -p "$out")
    { time "$@" --threads 1 --quiet --json --out "$run/run" >"$run/answer" 2>"$run/err" || touch "$run/failed"; } 2>"$run/time"
    if [ -e "$run/failed" ]; then
        echo "baseline: $* failed:" >&2
        tail -3 "$run/err" >&2
        echo "failed failed"
        return
    fi
    awk '{ printf "%.1f ", $1 + $2 }' "$run/time"
    answer "$run/answer"
}

# The verdict and the effects found of a search, the last line of whose answer holds them; else reduced χ² of each fit.
answer() {
    local last
    last=$(tail -n 1 "$1")
    if [[ "$last" == *'"verdict"'* ]]; then
        grep -o '"verdict":"[^"]*"\|"found":\[[^]]*\]' <<<"$last" | sed 's/"verdict"://; s/"found"://' | tr -d '"' | sort | tr '\n' ' ' || true
    else
        grep -o '"reduced_chi2":[0-9.]*' "$1" | sed 's/.*://' | awk '{ printf "%.3f ", $1 }' || true
    fi
}

# A row: what, then, now, ratio, answers of both.
row() {
    local what=$1
    shift
    local before after
    before=$(measured "$then_fct" "$@")
    after=$(measured "$now_fct" "$@")
    awk -v w="$what" -v a="$before" -v b="$after" 'BEGIN {
        split(a, x, " "); split(b, y, " ")
        sub(/^[^ ]* */, "", a); sub(/^[^ ]* */, "", b); sub(/ *$/, "", a); sub(/ *$/, "", b)
        ratio = (x[1] + 0 > 0 && y[1] + 0 > 0) ? sprintf("%.2f", y[1] / x[1]) : "–"
        printf "| %s | %s | %s | %s | %s | %s |\n", w, x[1], y[1], ratio, a, b
    }'
}

# One record of a folder.
search() {
    if [ -f "$1/config.toml" ]; then
        row "discover $(basename "$1")" discover "$1/config.toml"
    else
        echo "baseline: no record $1 (FCT_SHARED names the folder)" >&2
        exit 2
    fi
}

echo "| work | $commit, CPU s | now, CPU s | ratio | $commit answers | now |"
echo "|---|---|---|---|---|---|"
for work in "${wanted[@]}"; do
    case $work in
        identify) row "identify configs/FCT1.toml" identify configs/FCT1.toml ;;
        batch) row "batch FCT1–FCT5" batch configs/FCT1.toml configs/FCT2.toml configs/FCT3.toml configs/FCT4.toml configs/FCT5.toml ;;
        practice | real) for record in "$shared/$work"/*/; do search "${record%/}"; done ;;
        practice/* | real/*) search "$shared/$work" ;;
        *)
            echo "baseline: no work \`$work\`: identify, batch, practice, real, practice/RECORD, real/RECORD" >&2
            exit 2
            ;;
    esac
done
