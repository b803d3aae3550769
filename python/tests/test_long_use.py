"""The example of the README, and a hundred fits in one process."""

import pathlib
import subprocess
import sys

from conftest import command
from test_campaign import INTACT, MODEL

import fct

PAGE = 4096


def test_the_example_names_its_effect_and_draws_it(tmp_path):
    example = pathlib.Path(__file__).resolve().parents[1] / "examples/named_effect.py"
    done = subprocess.run([sys.executable, example], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "missing: drift" in done.stdout and "explains the records" in done.stdout
    assert (tmp_path / "named_effect.png").stat().st_size > 10_000


def resident():
    """Memory of this process, bytes."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * PAGE


def test_a_hundred_fits_leave_no_memory_behind(tmp_path):
    text = INTACT.replace("sK", "s1").replace("1K", "11").replace("seed = K", "seed = 1")
    tmp_path.joinpath("s1.toml").write_text(text)
    command(tmp_path, "simulate", "s1.toml")
    fit = tmp_path / "fit.toml"
    fit.write_text('specimen = "runs/s1/specimen.toml"\n' + MODEL)
    # The first ones fill what is kept for good: thread pools, the allocator's arenas, modules.
    for _ in range(20):
        first = fct.identify(fit)
    before = resident()
    for _ in range(100):
        last = fct.identify(fit)
    grown = resident() - before
    print(f"100 fits: {grown / 2**20:.1f} MB")
    assert last == first
    # One answer with its curves is some 30 kB: a hundred kept would show.
    assert grown < 2 * 2**20
