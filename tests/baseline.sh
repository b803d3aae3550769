#!/usr/bin/env bash
# CPU seconds of the targets of docs/performance.md, as ratios to an earlier commit that is built beside this one: the two
# programs take turns on every work, so that a machine that changes its speed changes both. Not on a busy machine.
# Usage: tests/baseline.sh [identify|batch|practice|real]...   (all of them: hours, most of it the earlier commit's)
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
then_fct=$top/target/baseline/build/release/fct
now_fct=${CARGO_TARGET_DIR:-$top/target}/release/fct

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
runs=0

# CPU seconds of `$1 COMMAND…`, user and system, children included; what it answers in $out/N/.
cpu() {
    runs=$((runs + 1))
    local TIMEFORMAT='%U %S'
    { time "$@" --threads 1 --quiet --out "$out/$runs" >/dev/null 2>&1; } 2>&1 | awk '{ printf "%.1f", $1 + $2 }'
}

# A row: what, then, now, ratio.
row() {
    local what=$1
    shift
    local before after
    before=$(cpu "$then_fct" "$@")
    after=$(cpu "$now_fct" "$@")
    awk -v w="$what" -v a="$before" -v b="$after" 'BEGIN { printf "| %s | %s | %s | %.2f |\n", w, a, b, b / a }'
}

echo "| work | $commit, CPU s | now, CPU s | ratio |"
echo "|---|---|---|---|"
for work in "${wanted[@]}"; do
    case $work in
        identify) row "identify configs/FCT1.toml" identify configs/FCT1.toml ;;
        batch) row "batch FCT1–FCT5" batch configs/FCT1.toml configs/FCT2.toml configs/FCT3.toml configs/FCT4.toml configs/FCT5.toml ;;
        practice | real)
            found=0
            for config in "$shared/$work"/*/config.toml; do
                [ -f "$config" ] || continue
                found=1
                row "discover $(basename "$(dirname "$config")")" discover "$config"
            done
            [ $found = 1 ] || echo "baseline: no records in $shared/$work (FCT_SHARED names the folder)" >&2
            ;;
        *)
            echo "baseline: no work \`$work\`: identify, batch, practice, real" >&2
            exit 2
            ;;
    esac
done
