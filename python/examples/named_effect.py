"""From two records to a named effect, with a plot: ``python python/examples/named_effect.py``; less than a minute.

The records are SYNTHETIC: computed on a finer mesh than the fit's, with noise, by a load cell whose zero drifts. The
model that is fitted knows nothing of that.
"""

import pathlib
import tempfile

import numpy as np

import fct

BULK = {"mu_kPa": 6.0, "k1_kPa": 700.0, "k2": 15.0, "gamma_deg": 42.0, "kappa": 0.22}
HELD = {name: {"start": BULK[name], "fixed": True} for name in ("mu_kPa", "gamma_deg", "kappa")}
SIZES = {"length_mm": 8, "width_mm": 6, "thickness_mm": 0.8, "cut_mm": 1.5}


def record(folder: pathlib.Path) -> None:
    """Writes pull.csv and tear.csv as a testing machine would."""
    pull = [{"to_mm": 2.0, "rate_mm_per_s": 0.05}]
    tear = [{"to_mm": to, "rate_mm_per_s": 0.05} for to in (2.0, 1.0, 5.0)]
    truth = fct.Model(
        mesh={"divisions": [8, 8, 1]},
        bulk=BULK,
        interface={"gc_N_per_mm": 0.15, "sigma_c_MPa": 0.08},
        solver={"step_mm": 0.05},
        effects={"drift": {"c_N_per_s": 1.5e-4}},
    )
    tests = [fct.Test("uniaxial", protocol=pull), fct.Test("tearing", protocol=tear)]
    dice = np.random.default_rng(7)
    for name, run in fct.simulate(fct.Specimen(**SIZES, tests=tests), truth).tests.items():
        noise = 0.005 * run["force_N"].max() * dice.standard_normal(len(run))
        table = run[["time_s", "displacement_mm"]].assign(force_N=run["force_N"] + noise)
        table.columns = ["Time (s)", "Extension (mm)", "Load (N)"]
        table.to_csv(folder / f"{'pull' if name == 'uniaxial' else 'tear'}.csv", index=False)


def main() -> None:
    """Reads, fits, asks what is missing, adds it."""
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        record(folder)
        tests = [
            fct.read_record(folder / "pull.csv", kind="uniaxial"),
            fct.read_record(folder / "tear.csv", kind="tearing"),
        ]
    strip = fct.Specimen(**SIZES, tests=tests, name="strip", provenance="synthetic, computed by fct")
    model = fct.Model(
        mesh={"divisions": [6, 6, 1]},
        bulk=HELD | {"k1_kPa": 500.0, "k2": 12.0},
        interface={"gc_N_per_mm": 0.12, "sigma_c_MPa": 0.06},
    )
    fit = fct.identify(strip, model)
    print(fit)
    found = fct.diagnose(fit)
    print(found.screen[["expected_fall", "p_value", "visible"]].head(3))
    if not found.found:
        raise SystemExit("nothing is called for")
    better = fit.add(found.found[0]).identify()
    print(better, fct.ladder(fit, better).frame, better.params[["value", "unit", "low_95", "high_95"]], sep="\n")
    axes = better.plot("tearing")
    before = fit.curves["tearing"]
    axes.plot(before["displacement_mm"], before["force_model_N"], "--", label=f"without {found.found[0]}")
    axes.legend()
    axes.figure.savefig("named_effect.png", dpi=150)
    print(f"missing: {found.found[0]}; the plot is in named_effect.png")


if __name__ == "__main__":
    main()
