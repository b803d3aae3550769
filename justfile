# Shortcuts for https://just.systems; every recipe is a cargo command that also works pasted.

# This list.
default:
    @just --list

# All tests but the slow ones, as in the README.
test:
    cargo test --workspace

# What must hold before a change goes in: format, lints, docs, tests.
ci:
    ./.ci/run

# Whole fits that are too long for every change: each effect found again beside an unknown base, a start from which the record
# cannot be followed, long records with jitter, the power that `fct design` promises, peels, three cases of the hidden study and its laws of other people. Some ten minutes.
slow:
    cargo test --workspace -- --ignored every_effect_is_found_again is_mended ten_times_off rows_and_jitter noisy_repeats_confirm a_steady_peel synthetic_peel synthetic_sheet another_law_is_called what_bends_the_base hidden_effects_are_named laws_of_other_people a_limit_point_beyond

# The slow checks of docs/verification.md, with their figures.
verification:
    cargo test --release -p fem -- --ignored --nocapture

# The targets of docs/performance.md as ratios to commit 789214f, which is built beside this one (`tests/baseline.sh identify`: one
# row). Hours, most of them the earlier commit's; not on a busy machine.
bench *WORK:
    tests/baseline.sh {{WORK}}

# Times of the hot loops: law points, assembly, factorisation, a torn strip, a search's iteration and screen, and their ratios. Not on a busy machine.
kernels:
    cargo bench -p hgo --bench point
    cargo bench -p cohesive --bench point
    cargo bench -p fem --bench forward
    cargo bench -p analysis --bench iteration
    cargo bench -p evidence --bench evidence
    cargo run --release -q -p workspace-tests --example ratios

# CPU seconds of the peers' strips, whole and with their symmetry; FElupe beside them: tests/data/peers/tension.py. Not on a busy machine.
peers:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release -q
    out=$(mktemp -d)
    for strip in tension_20x50x4 tear_8x20x2 tear_20x50x4; do
        for symmetry in none auto; do
            sed "s/symmetry = .*/symmetry = \"$symmetry\"/" tests/data/peers/$strip.toml > "$out/$strip-$symmetry.toml"
            echo "$strip, symmetry = $symmetry"
            (time ./target/release/fct simulate "$out/$strip-$symmetry.toml" --threads 1 --out "$out/$strip-$symmetry" > /dev/null 2>&1) 2>&1 | grep -E "user|sys"
        done
    done

# The search for the missing effect on the practice records beside this repository.
practice:
    cargo run --release -p analysis --example disc -- ../shared/practice/*/config.toml

# The hidden-effect study: makes 276 cases in runs/hidden, diagnoses them, writes docs/hidden.md. A day; resumes.
hidden:
    cargo run --release -p hidden-suite -- all

# Every seventh case of fresh seeds: most of what docs/hidden.md has. Three hours; resumes.
hidden-sample:
    cargo run --release -p hidden-suite -- all --seed 84000 --every 7 --limit-s 5000 --dir runs/hidden-84000

# The same on small strips with two areas, for so many minutes: what goes wrong is found sooner. Seconds to some minutes a case; resumes.
hidden-small MINUTES="60":
    cargo run --release -p hidden-suite -- all --size small --seed 120000 --minutes {{MINUTES}} --doc runs/hidden-small/page.md

# The study on seed 98000, on which nothing was chosen, for so many minutes; its results are kept in tests/hidden/results, so that it
# goes on from there on any machine. The page goes beside the cases.
hidden-fresh MINUTES="150":
    cargo run --release -p hidden-suite -- all --seed 98000 --limit-s 5000 --dir runs/hidden-98000 --results tests/hidden/results/98000.jsonl --commit "$(git rev-parse --short HEAD)" --minutes {{MINUTES}} --doc runs/hidden-98000/page.md

# Every eleventh case of it, both protocols and all strengths among them; the report goes beside the cases.
hidden-quick:
    cargo run --release -p hidden-suite -- all --every 11 --doc runs/hidden/quick.md

# The same on the public measurements beside this repository (docs/real-data.md).
real:
    cargo run --release -p analysis --example disc -- ../shared/real/*/config.toml

# Every effect in twenty records of its own: how often intervals hold, errors of the amplitudes (14 minutes).
recovered:
    cargo test --release -p analysis recovered:: -- --ignored --nocapture

# Coverage of intervals and uniformity of the screen's p-values, with finite elements (docs/reliability.md): mesh error above the noise, and below it. Forty minutes.
coverage:
    cargo run --release -p analysis --example coverage -- 200
    cargo run --release -p analysis --example coverage -- 200 0.025 24

# Ten million damaged files for the readers, a hundred thousand for the way to a model; on a disk the files take most of the time.
fuzz:
    #!/usr/bin/env bash
    set -euo pipefail
    if [ -d /dev/shm ]; then export TMPDIR=/dev/shm; fi
    FCT_CASES=2500000 cargo test --release -p input _panic
    FCT_CASES=250000 cargo test --release -p records round_trip::
    FCT_CASES=100000 cargo test --release -p workspace-tests config_to_model::

# Changes the code of four crates, one place at a time, and asks their tests to notice (docs/reliability.md). Hours; needs `cargo install cargo-mutants --locked`. Without `--shard`: every mutant.
mutants:
    #!/usr/bin/env bash
    set -euo pipefail
    # In a clone: the sources are changed where they stand.
    rm -rf target/mutants && git clone -q . target/mutants && cd target/mutants
    export CARGO_INCREMENTAL=1 CARGO_PROFILE_DEV_DEBUG=0 CARGO_PROFILE_DEV_OPT_LEVEL=0
    export CARGO_TARGET_DIR="$PWD/target" PROPTEST_CASES=64 PROPTEST_DISABLE_FAILURE_PERSISTENCE=1
    printf '[profile.dev.package."*"]\nopt-level = 1\n' >> .cargo/config.toml
    # Exit codes 2 and 3 say that mutants were missed or timed out.
    run() { mkdir -p "target/$1" && cargo mutants --in-place --sharding round-robin --baseline skip --build-timeout 240 -o "target/$1" -p "$1" --test-package "$@" || [ $? -le 3 ]; }
    run hgo --shard 0/4 --timeout 30 -- --lib --tests
    run cohesive --timeout 30 -- --lib --tests
    run diagnose --shard 0/24 --timeout 60 -- --lib --tests -- --skip p_values_are --skip false_ --skip without_bias --skip steps_do_not
    run inverse --shard 0/12 --timeout 60 -- --lib --tests -- --skip white_noise --skip autocorrelated_noise --skip plain_sum --skip numerical_error_of --skip second_stage

# Identify, discover and batch killed 167 times each and stopped by signals 67 times each; full disk, vanished directory.
kills:
    FCT_KILLS=167 FCT_SIGNALS=67 cargo test --release -p fct-cli killed:: -- --nocapture --test-threads 1

# Every file of a run directory damaged in nine ways, read by every command.
damaged:
    FCT_EVERY=1 cargo test --release -p fct-cli damaged:: -- --nocapture

# Licence of every crate that is linked into fct, and crates that come in two versions.
audit:
    cargo tree --locked -p fct-cli -e normal --prefix none -f '{l}  {p}' | sort -u
    cargo tree --locked -p fct-cli -e normal --duplicates

# The report and the workbench in a real browser (Chromium): rungs clicked, points hovered, numbers checked; files dropped,
# effects added, errors falling. `FCT_SCREENSHOTS=DIR` keeps pictures.
browser:
    cargo test -p fct-cli browser:: -- --ignored --nocapture

# Pictures of the workbench for the book, and all others that the browser tests take, in target/pictures.
workbench-picture:
    mkdir -p target/pictures
    FCT_SCREENSHOTS="$PWD/target/pictures" cargo test -p fct-cli workbench_browser:: -- --ignored
    for name in "" -empty -geometry -slider -stretch -hover; do cp target/pictures/workbench$name.png docs/book/src/img/; done

# The same journey on a record of another program with a hidden effect, beside this repository. Minutes; `FCT_CASE` for
# another one, `FCT_SCREENSHOTS=DIR` keeps pictures.
workbench-practice:
    FCT_PRACTICE="${FCT_PRACTICE:-$PWD/../shared/practice}" cargo test --release -p fct-cli workbench_practice:: -- --ignored --nocapture

# The README's film of the workbench: a raw file dropped, the missing effect added, the error falling; pictures by Chromium,
# put together by Pillow.
workbench-film:
    #!/usr/bin/env bash
    set -euo pipefail
    rm -rf target/film && mkdir -p target/film
    FCT_FILM="$PWD/target/film" cargo test -p fct-cli the_error_falls_in_the_hands -- --ignored
    [ -d target/venv ] || python3 -m venv target/venv
    target/venv/bin/pip install -q pillow
    target/venv/bin/python docs/img/film.py target/film docs/img/workbench.gif

# First paint, sliders, frames, long records, memory of the workbench's page: the table of docs/performance.md. Not on a busy
# machine. The practice case lies beside this repository.
workbench-figures:
    FCT_PRACTICE="${FCT_PRACTICE:-$PWD/../shared/practice}" cargo test --release -p fct-cli workbench_figures:: -- --ignored --nocapture

# The pages that are made from the program: keys, JSON schema, catalogue of effects.
book:
    UPDATE=1 cargo test -p fct-cli reference::

# The manual as a web site in target/book; needs `cargo install mdbook`.
book-html:
    mdbook build docs/book

# Changes of the public interface against a revision: what breaks it needs a new minor version before 1.0.
semver revision="HEAD~1":
    cargo semver-checks --workspace --baseline-rev {{revision}}

# Every hostile file and command line, every number of the tables at values that nobody means (minutes).
hostile:
    FCT_HOSTILE=all cargo test -p fct-cli -- hostile:: command_lines:: --nocapture
    FCT_ALL=1 cargo test -p workspace-tests every_number:: -- --nocapture

# What `fct check` promises of the practice records beside this repository, beside what `discover` found (docs/reliability.md).
doctor-practice:
    cargo run --release -p workspace-tests --example doctor_practice -- ../shared/practice

# Which parameters it promises, beside what the answers of `discover` know (docs/reliability.md); RUNS holds its run
# directories, each named as its case.
doctor-parameters RUNS:
    cargo run --release -p workspace-tests --example doctor_parameters -- ../shared/practice {{RUNS}}

# The same on fresh records of the study of hidden effects (`hidden generate`), each identified with what is hidden in the
# model; CASES holds their folders.
doctor-parameters-hidden CASES RUNS:
    #!/usr/bin/env bash
    set -euo pipefail
    cargo build --release
    for case in "{{CASES}}"/case-*; do
        run="{{RUNS}}/$(basename "$case")"
        [ -d "$run" ] || target/release/fct identify "$case/known.toml" --out "$run" --quiet > /dev/null
    done
    cargo run --release -p workspace-tests --example doctor_parameters -- "{{CASES}}" "{{RUNS}}"

# The power and the standard errors that `fct design` promises, against noisy repeats (docs/reliability.md). Seven minutes; `FCT_REPEATS=300` for more draws.
design-power:
    cargo test --workspace --lib design::repeats:: -- --ignored --nocapture --test-threads 1

# Records of 20,000 and 200,000 rows with jitter against 400 clean ones: times and values. A reduction of a million rows.
long-records:
    cargo test --workspace --test all -- sampling:: reduction:: --ignored --nocapture --test-threads 1

# A study as a Slurm array on one node, by Debian's package (installed if need be; root), against the serial run. Ten minutes.
slurm:
    cargo build --workspace
    tests/slurm.sh target/debug/fct

# The Python package built into target/venv, and its tests; with Dask, scipy and statsmodels where pip can install them.
python:
    #!/usr/bin/env bash
    set -euo pipefail
    [ -d target/venv ] || python3 -m venv target/venv
    target/venv/bin/pip install -q maturin numpy pandas pytest mypy matplotlib tqdm scipy statsmodels pyarrow "dask[distributed]" felupe tensortrax nbclient nbformat ipykernel
    cargo build --workspace
    export CARGO_TARGET_DIR="$PWD/target" VIRTUAL_ENV="$PWD/target/venv" PATH="$PWD/target/venv/bin:$PATH"
    cd python && maturin develop --locked -q && pytest -s

# `fct export felupe` run in FElupe, its forces compared with ours (needs `just python` once).
felupe:
    cd python && ../target/venv/bin/pytest -s tests/test_export.py
