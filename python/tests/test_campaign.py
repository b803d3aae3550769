"""Studies: any executor gives the bits of the serial run; workers that are killed lose nothing."""

import json
import os
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from conftest import command, timeless

import fct

INTACT = """name = "sK"
[geometry]
length_mm = 8.0
width_mm = 1K.0
thickness_mm = 0.8
[[tests]]
kind = "uniaxial"
ends = "sliding"
protocol = [{ to_mm = 1.5, rate_mm_per_s = 0.05 }]
[mesh]
divisions = [1, 2, 1]
[bulk]
mu_kPa = 6.0
k1_kPa = 700.0
k2 = 15.0
gamma_deg = 42.0
kappa = 0.22
[solver]
step_mm = 0.05
[output]
noise = 0.005
seed = K
fields = false
"""

MODEL = """[mesh]
divisions = [1, 2, 1]
[bulk]
mu_kPa = { start = 6.0, fixed = true }
k1_kPa = 500.0
k2 = 12.0
gamma_deg = { start = 42.0, fixed = true }
kappa = { start = 0.22, fixed = true }
"""


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    rows = ""
    for k in (1, 2):
        folder.joinpath(f"s{k}.toml").write_text(INTACT.replace("sK", f"s{k}").replace("1K", f"1{k}").replace("seed = K", f"seed = {k}"))
        command(folder, "simulate", f"s{k}.toml")
        rows += f'[[specimens]]\nfile = "runs/s{k}/specimen.toml"\n'
    folder.joinpath("model.toml").write_text(MODEL)
    tail = rows + '[[models]]\nname = "base"\nconfig = "model.toml"\n[repeats]\nbootstrap = 20\n'
    for name in ("serial", "threads", "processes", "dask"):
        folder.joinpath(f"{name}.toml").write_text(f'folder = "{name}"\n{tail}')
    command(folder, "campaign", "run", "serial.toml", "--threads", "1")
    return folder


def results(folder):
    return {p.name: timeless(json.loads(p.read_text())) for p in (folder / "results").glob("*.json")}


def finish(here, name, executor):
    end = fct.campaign.run(here / f"{name}.toml", executor)
    assert (end["done"], end["failed"], end["set_aside"]) == (42, 0, 0)
    assert results(here / name) == results(here / "serial")


def test_threads_and_the_command_share_a_study(here):
    command(here, "campaign", "run", "threads.toml", "--shard", "1/2", "--threads", "1")
    assert fct.campaign.status(here / "threads.toml")["done"] == 21
    with ThreadPoolExecutor(2) as pool:
        finish(here, "threads", pool)
    report = fct.campaign.report(here / "threads.toml")
    assert "Leng" in report.methods and len(report.specimens) == 2


def test_a_process_that_is_killed_costs_its_task_only(here):
    stop = threading.Event()

    def kill():
        # Workers of the default executor are children of this process.
        while not stop.wait(0.05):
            done = list((here / "processes" / "results").glob("*.json")) if (here / "processes").exists() else []
            mine = [c for c in children() if len(done) >= 2]
            if mine:
                os.kill(mine[-1], signal.SIGKILL)
                return

    thread = threading.Thread(target=kill)
    thread.start()
    try:
        finish(here, "processes", None)
    finally:
        stop.set()
        thread.join()


def children():
    """Worker processes of this one."""
    out = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            stat = open(f"/proc/{pid}/stat").read()
            words = open(f"/proc/{pid}/cmdline").read()
        except OSError:
            continue
        if int(stat.rsplit(")", 1)[1].split()[1]) == os.getpid() and "spawn_main" in words:
            out.append(int(pid))
    return out


def test_dask_loses_a_worker_and_nothing_else(here):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            pids = list(client.run(os.getpid).values())

            def kill():
                begun = time.monotonic()
                while time.monotonic() - begun < 60:
                    if len(list((here / "dask" / "results").glob("*.json"))) >= 2:
                        os.kill(pids[0], signal.SIGKILL)
                        return
                    time.sleep(0.02)

            thread = threading.Thread(target=kill)
            thread.start()
            finish(here, "dask", client.get_executor(pure=False))
            thread.join()


def test_a_plan_names_wrong_rows(here):
    here.joinpath("wrong.toml").write_text('[[specimens]]\nfile = "nowhere.toml"\n')
    plan = fct.campaign.plan(here / "wrong.toml")
    assert plan["wrong"][0]["row"] == 1 and "nowhere.toml" in plan["wrong"][0]["reason"]
    with pytest.raises(fct.InputError, match="no_study.toml"):
        fct.campaign.plan(here / "no_study.toml")


# The thirteen BCG trials: log risk ratio, variance (Colditz et al. 1994; metafor's dat.bcg).
TRIALS = np.array(
    [
        [4, 119, 11, 128],
        [6, 300, 29, 274],
        [3, 228, 11, 209],
        [62, 13536, 248, 12619],
        [33, 5036, 47, 5761],
        [180, 1361, 372, 1079],
        [8, 2537, 10, 619],
        [505, 87886, 499, 87892],
        [29, 7470, 45, 7232],
        [17, 1699, 65, 1600],
        [186, 50448, 141, 27197],
        [5, 2493, 3, 2338],
        [27, 16886, 29, 17825],
    ],
    float,
)


def reference(y, v):
    """tau² by the restricted likelihood as scipy maximises it; Hartung & Knapp's standard error."""
    optimize = pytest.importorskip("scipy.optimize")

    def minus(tau2):
        w = 1 / (v + tau2)
        mean = (w * y).sum() / w.sum()
        return 0.5 * (np.log(v + tau2).sum() + np.log(w.sum()) + (w * (y - mean) ** 2).sum())

    top = 10 * y.var()
    tau2 = optimize.minimize_scalar(minus, bounds=(0, top), method="bounded", options={"xatol": 1e-13}).x
    w = 1 / (v + tau2)
    mean = (w * y).sum() / w.sum()
    q = (w * (y - mean) ** 2).sum() / (len(y) - 1)
    return tau2, mean, np.sqrt(max(q, 1.0) / w.sum())


def test_the_mixed_effects_figures_are_those_of_scipy_and_statsmodels():
    a, b, c, d = TRIALS.T
    y, v = np.log((a / (a + b)) / (c / (c + d))), 1 / a - 1 / (a + b) + 1 / c - 1 / (c + d)
    ours = fct.campaign.pooled(y, np.sqrt(v))
    tau2, mean, se = reference(y, v)
    apart = [ours["between_sd"] ** 2 / tau2 - 1, ours["mean"] / mean - 1, ours["std_error"] / se - 1]
    print("REML against scipy, relative:", apart)
    assert np.abs(apart).max() < 1e-6
    meta = pytest.importorskip("statsmodels.stats.meta_analysis")
    laird = meta.combine_effects(y, v, method_re="dl")
    print("DerSimonian-Laird against statsmodels, relative:", ours["tau2_dersimonian_laird"] / laird.tau2 - 1)
    assert abs(ours["tau2_dersimonian_laird"] / laird.tau2 - 1) < 1e-12
    assert abs(ours["q"] / laird.q - 1) < 1e-12
    from scipy import stats

    half = stats.t.ppf(0.975, 12) * ours["std_error"]
    assert np.allclose(ours["interval_95"], [mean - half, mean + half], rtol=1e-7)
