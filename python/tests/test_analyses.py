"""The analyses: the command's numbers to the bit, results that pickle, callbacks, Ctrl-C."""

import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest
from conftest import command, timeless

import fct
from fct.records import table


def specimen(folder):
    """The synthetic specimen as an object."""
    lines = (folder / "runs/strip/specimen.toml").read_text().splitlines()
    noise = [float(line.split("=")[1].split("#")[0]) for line in lines if line.startswith("force_sd_N")]
    tests = [
        fct.Test(kind, fct.read_record(folder / f"runs/strip/{kind}.csv"), keys={"force_sd_N": sd})
        for kind, sd in zip(("uniaxial", "tearing"), noise, strict=True)
    ]
    provenance = next(line for line in lines if line.startswith("provenance")).split('"')[1]
    return fct.Specimen(
        length_mm=8, width_mm=6, thickness_mm=0.8, cut_mm=1.5, tests=tests, name="strip", provenance=provenance
    )


def test_identify_gives_the_command_s_numbers_to_the_bit(folder, fit):
    theirs = command(folder, "identify", "fit.toml", "--out", "run")
    assert timeless(fit.answer) == timeless(theirs)
    for test in ("uniaxial", "tearing"):
        stored = table((folder / f"run/curves/{test}.csv").read_text())
        for column in ("time_s", "displacement_mm", "force_measured_N", "force_model_N"):
            assert np.array_equal(fit.curves[test][column], stored[column])


def test_objects_give_the_same_as_files(folder, fit):
    model = fct.Model.from_file(folder / "fit.toml")
    assert model == fct.Model(
        mesh={"divisions": [4, 4, 1]},
        bulk={
            "mu_kPa": {"start": 6.0, "fixed": True},
            "k1_kPa": 500.0,
            "k2": 12.0,
            "gamma_deg": {"start": 42.0, "fixed": True},
            "kappa": {"start": 0.22, "fixed": True},
        },
        interface={"gc_N_per_mm": 0.12, "sigma_c_MPa": 0.06},
    )
    again = fct.identify(specimen(folder), model, threads=1)
    assert again.params.equals(fit.params)
    assert again == fit and pickle.loads(pickle.dumps(again)) == fit
    other = pickle.loads(pickle.dumps(again))
    other.answer["parameters"][0]["value"] += 1e-15
    assert other != fit


def test_a_fit_shows_itself(fit):
    assert list(fit.params.columns[:2]) == ["value", "unit"]
    assert fit.params.loc["interface.area[1].gc", "unit"] == "N/mm"
    one = fit.path_means.loc["gc"]
    assert (one["value"], one["counted"], one["areas"]) == (fit.params.loc["interface.area[1].gc", "value"], 1, 1)
    assert abs(fit.params.loc["interface.area[1].gc", "value"] / 0.15 - 1) < 0.1
    page = fit._repr_html_()
    assert "synthetic" in page and "interface.area[1].gc" in page and "explains the records" in page
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    assert len(fit.plot("uniaxial").lines) == 2
    assert len(fct.ladder(fit).plot().patches) == 1


def test_an_effect_is_added_and_the_ladder_counts_it(folder, fit):
    problem = fit.add("drift")
    assert problem.model.effects == ("drift",) and fit.model is None
    more = problem.identify()
    frame = fct.ladder(more, fit).frame
    assert list(frame["effects"]) == ["none", "drift"]
    assert list(frame["bulk_law"]) == ["hgo", "hgo"]
    assert list(frame["interface_law"]) == ["exponential", "exponential"]
    # The records do not drift: the effect changes next to nothing.
    assert abs(frame["rms_N"].iloc[1] / frame["rms_N"].iloc[0] - 1) < 0.05
    assert abs(more.params.loc["effects.drift.c", "value"]) < 1e-4
    with pytest.raises(fct.InputError, match="already"):
        more.add("drift")
    assert problem.model.drop("drift").effects == ()


def test_diagnose_screens_the_whole_catalogue(folder, fit):
    found = fct.diagnose(fit)
    assert len(found.screen) == len(fct.effects())
    assert found.verdict in ("nothing_missing", "explained", "ambiguous", "unexplained")
    command(folder, "identify", "fit.toml", "--out", "base")
    assert timeless(command(folder, "diagnose", "base")) == timeless(found.answer)


def test_simulate_gives_the_command_s_numbers(folder):
    ours = fct.simulate(folder / "strip.toml")
    assert timeless(ours.answer) == timeless(command(folder, "simulate", "strip.toml", "--out", "forward"))
    pull = fct.simulate(
        specimen(folder), fct.Model.from_file(folder / "fit.toml"), protocol=[{"to_mm": 0.4, "rate_mm_per_s": 0.1}]
    )
    assert pull.tests["tearing"]["displacement_mm"].iloc[-1] == 0.4


def test_progress_is_told_and_an_exception_in_it_comes_out(folder):
    told = []
    fct.identify(folder / "fit.toml", progress=told.append)
    assert any("iteration" in text for text in told)

    def wrong(_):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        fct.identify(folder / "fit.toml", progress=wrong)


def test_the_interpreter_is_free_while_it_computes(folder):
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.wait(0.01):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    begun = time.monotonic()
    fct.identify(folder / "fit.toml", threads=1)
    seconds = time.monotonic() - begun
    stop.set()
    thread.join()
    assert len(ticks) > 10 * min(seconds, 1.0)


def test_ctrl_c_stops_within_a_second_and_keeps_the_best(folder):
    fine = (folder / "fit.toml").read_text().replace("[4, 4, 1]", "[12, 24, 2]")
    (folder / "fine.toml").write_text(fine)
    heard = threading.Event()
    pressed = []

    def press():
        heard.wait(120)
        time.sleep(0.3)
        pressed.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    # A shell that starts this in the background has SIGINT ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Thread(target=press, daemon=True).start()
    with pytest.raises(fct.Interrupted) as stopped:
        fct.identify(folder / "fine.toml", progress=lambda _: heard.set())
    signal.signal(signal.SIGINT, before)
    assert time.monotonic() - pressed[0] < 1.5  # a second, and what a busy machine adds
    assert isinstance(stopped.value, KeyboardInterrupt)
    assert any(path.startswith("bulk.") for path in stopped.value.best)


def test_bad_input_says_what_the_command_says(folder):
    bad = folder / "bad.toml"
    bad.write_text((folder / "fit.toml").read_text().replace("k1_kPa", "k1_kpa"))
    theirs = command(folder, "check", str(bad), code=2)
    with pytest.raises(fct.InputError) as error:
        fct.identify(bad)
    assert str(error.value) == theirs["error"]["reason"]
    assert error.value.faults == theirs["error"]["faults"]
    assert (error.value.faults[0]["line"], error.value.faults[0]["key"]) == (6, "k1_kpa")
    with pytest.raises(fct.InputError, match="nowhere.toml"):
        fct.check("nowhere.toml")
    assert issubclass(fct.InputError, fct.FctError)


def test_probabilities_of_a_search_are_a_frame():
    """A made-up answer: what a search says takes minutes."""
    sets = [
        {"effects": [], "probability": 0.02, "with_something_else": 0.01},
        {"effects": ["drift"], "probability": 0.9, "with_something_else": 0.05},
        {"effects": ["drift", "lag"], "probability": 0.02, "with_something_else": 0.0},
    ]
    answer = {"specimen": "x", "verdict": "explained", "found": ["drift"]}
    found = fct.Discovery(answer | {"posterior": {"sets": sets, "effects": {"drift": 0.97}, "nothing": 0.02}}, None)
    assert list(found.posterior["effects"]) == [("drift",), (), ("drift", "lag")]
    assert list(found.posterior["probability"]) == [0.9, 0.02, 0.02]
    assert fct.Discovery(answer, None).posterior is None


def test_values_averaged_over_what_may_be_missing_are_a_table() -> None:
    answer = {"specimen": "strip", "verdict": "explained", "found": ["drift"], "screen": [], "ladder": []}
    assert fct.Discovery(answer, None).averaged is None
    gc = {"value": 0.2, "unit": "N/mm", "interval_95": [0.19, 0.22]}
    mu = {"value": 0.01, "unit": "MPa", "interval_95": [0.008, 0.013]}
    averaged = {"path_means": {"gc": gc}, "parameters": {"bulk.mu": mu}, "share": 0.99}
    table = fct.Discovery(answer | {"averaged": averaged}, None).averaged
    assert table is not None
    assert list(table.index) == ["gc", "bulk.mu"]
    assert list(table.loc["gc"]) == [0.2, "N/mm", 0.19, 0.22]
