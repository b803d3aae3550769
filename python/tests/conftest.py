"""A small synthetic specimen, made by the command; results of the package are held against the command's."""

import json
import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILT = pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target")
FCT = os.environ.get("FCT") or next(
    (str(p) for p in (BUILT / "debug/fct", BUILT / "release/fct") if p.is_file()), "fct"
)

STRIP = """name = "strip"
[geometry]
length_mm = 8.0
width_mm = 6.0
thickness_mm = 0.8
cut_mm = 1.5
[[tests]]
kind = "uniaxial"
protocol = [{ to_mm = 2.0, rate_mm_per_s = 0.05 }]
[[tests]]
kind = "tearing"
protocol = [{ to_mm = 5.0, rate_mm_per_s = 0.05 }]
[mesh]
divisions = [4, 4, 1]
[bulk]
mu_kPa = 6.0
k1_kPa = 700.0
k2 = 15.0
gamma_deg = 42.0
kappa = 0.22
[interface]
gc_N_per_mm = 0.15
sigma_c_MPa = 0.08
[solver]
step_mm = 0.2
[output]
noise = 0.005
seed = 3
fields = false
"""

FIT = """specimen = "runs/strip/specimen.toml"
[mesh]
divisions = [4, 4, 1]
[bulk]
mu_kPa = { start = 6.0, fixed = true }
k1_kPa = 500.0
k2 = 12.0
gamma_deg = { start = 42.0, fixed = true }
kappa = { start = 0.22, fixed = true }
[interface]
gc_N_per_mm = 0.12
sigma_c_MPa = 0.06
"""


def command(folder, *arguments, code=0):
    """The answer of the command."""
    done = subprocess.run([FCT, *arguments, "--json", "--quiet"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return json.loads(done.stdout)


def timeless(x):
    """Without what differs from run to run."""
    if isinstance(x, dict):
        return {k: timeless(v) for k, v in x.items() if k not in ("seconds", "cost")}
    return [timeless(v) for v in x] if isinstance(x, list) else x


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Holds strip.toml, its synthetic specimen in runs/strip, fit.toml."""
    here = tmp_path_factory.mktemp("strip")
    here.joinpath("strip.toml").write_text(STRIP)
    here.joinpath("fit.toml").write_text(FIT)
    command(here, "simulate", "strip.toml")
    return here


@pytest.fixture(scope="session")
def fit(folder):
    import fct

    return fct.identify(folder / "fit.toml", threads=2)
