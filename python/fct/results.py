"""What the analyses answer."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from .case import apart

if TYPE_CHECKING:
    from .analyses import Problem
    from .case import Model

Curves = dict[str, pd.DataFrame]

_TIMES = ("seconds", "cost")


def _timeless(x: Any) -> Any:
    """An answer without what differs from run to run."""
    if isinstance(x, Mapping):
        return {k: _timeless(v) for k, v in x.items() if k not in _TIMES}
    return [_timeless(v) for v in x] if isinstance(x, list) else x


class _Answer:
    """An answer of the command as ``answer``, the document of ``--json``. Answers pickle, and are equal if all but
    their times is."""

    def __init__(self, answer: dict[str, Any]) -> None:
        self.answer = answer

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and _timeless(self.answer) == _timeless(other.answer)

    __hash__ = None  # type: ignore[assignment]


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots()[1]


class Fit(_Answer):
    """A finished identification."""

    def __init__(
        self, answer: dict[str, Any], curves: Curves, jacobian: Curves, specimen: Any, model: Model | None
    ) -> None:
        super().__init__(answer)
        self.curves = curves
        """By test: ``time_s``, ``displacement_mm``, ``force_measured_N``, ``force_model_N``, ``residual_N``, camera
        channels where they were measured, ``segment``."""
        self.jacobian = jacobian
        """By test: derivative of ``force_model_N`` by each free parameter, N per its unit; columns are paths."""
        self.specimen = specimen
        self.model = model

    @property
    def path_means(self) -> pd.DataFrame:
        """Means along the tear path by name (``gc``, ``sigma_c``), where the records fix them: value, unit, std_error,
        low_95, high_95, counted (areas in the mean), areas."""
        rows = [
            {
                "name": name,
                "value": m["value"],
                "unit": m["unit"],
                "std_error": m["std_error"],
                "low_95": m["interval_95"][0],
                "high_95": m["interval_95"][1],
                "counted": m["counted"],
                "areas": m["areas"],
            }
            for name, m in self.answer.get("path_means", {}).items()
        ]
        columns = ["name", "value", "unit", "std_error", "low_95", "high_95", "counted", "areas"]
        return pd.DataFrame(rows, columns=columns).set_index("name")

    @property
    def params(self) -> pd.DataFrame:
        """By path: value, unit, std_error, low_95, high_95, identifiable, at_bound."""
        rows = [
            {
                "path": p["path"],
                "value": p["value"],
                "unit": p["unit"],
                "std_error": p["std_error"],
                "low_95": p["interval_95"][0],
                "high_95": p["interval_95"][1],
                "identifiable": p["identifiable"],
                "at_bound": p["at_bound"],
            }
            for p in self.answer["parameters"]
        ]
        frame = pd.DataFrame(rows).set_index("path")
        numbers = ["std_error", "low_95", "high_95"]
        return frame.astype(dict.fromkeys(numbers, float))

    @property
    def tests(self) -> pd.DataFrame:
        """Fit of each test: rms_N, noise_N, reduced_chi2, points, …."""
        rows = {n: {k: v for k, v in t.items() if k != "energy"} for n, t in self.answer["tests"].items()}
        return pd.DataFrame.from_dict(rows, orient="index")

    @property
    def explained(self) -> bool:
        """Whether what the model leaves of the records is noise."""
        return bool(self.answer["explained"])

    @property
    def effects(self) -> list[str]:
        """Effects of the model."""
        return list(self.answer["effects"])

    def add(self, effect: str, **parameters: Any) -> Problem:
        """The same specimen with an effect added to the model: ``fit.add("viscoelastic").identify()``."""
        from .analyses import Problem

        specimen, model = apart(self.specimen, self.model)
        return Problem(specimen, model.add(effect, **parameters))

    def drop(self, effect: str) -> Problem:
        """The same with an effect taken away."""
        from .analyses import Problem

        specimen, model = apart(self.specimen, self.model)
        return Problem(specimen, model.drop(effect))

    def plot(self, test: str | None = None, ax: Any = None) -> Any:
        """Force (N) against displacement (mm), record and model, of one test (default: the last); matplotlib axes."""
        name = test or list(self.curves)[-1]
        curve, ax = self.curves[name], _axes(ax)
        ax.plot(curve["displacement_mm"], curve["force_measured_N"], ".", color="#777780", ms=3, label="record")
        ax.plot(curve["displacement_mm"], curve["force_model_N"], color="#D55E00", label="model")
        ax.set(xlabel="displacement (mm)", ylabel="force (N)", title=f"{self.answer['specimen']}: {name}")
        ax.legend()
        return ax

    def _lead(self) -> str:
        with_effects = f" with {' + '.join(self.effects)}" if self.effects else ""
        chi2 = self.answer["reduced_chi2_total"]
        if self.explained:
            return f"The model{with_effects} explains the records (reduced χ² {chi2:.3g})."
        return f"The model{with_effects} does not explain the records (reduced χ² {chi2:.3g})."

    def __repr__(self) -> str:
        return f"<fct.Fit {self.answer['specimen']}: {self._lead()}>"

    def _repr_html_(self) -> str:
        """The head of the report: one sentence, the provenance, values with intervals."""
        a = self.answer
        rows = "".join(_row(p) for p in a["parameters"])
        tests = "; ".join(
            f"{html.escape(n)}: rms {t['rms_N']:.3g} N, noise {t['noise_N']:.3g} N" for n, t in a["tests"].items()
        )
        return (
            f"<h3>{html.escape(a['specimen'])}</h3><p><b>{html.escape(self._lead())}</b></p>"
            f"<p>{html.escape(a['provenance'] or 'provenance not stated')}</p><p>{tests}</p>"
            "<table><thead><tr><th>parameter</th><th>value</th><th>unit</th><th>95 % interval</th><th></th></tr></thead>"
            f"<tbody>{rows}</tbody></table>"
        )

    def __eq__(self, other: object) -> bool:
        if not (isinstance(other, Fit) and super().__eq__(other)):
            return False
        mine, theirs = (self.curves, self.jacobian), (other.curves, other.jacobian)
        return all(
            a.keys() == b.keys() and all(a[n].equals(b[n]) for n in a) for a, b in zip(mine, theirs, strict=True)
        )

    __hash__ = None


def _row(p: Mapping[str, Any]) -> str:
    low, high = ("…" if x is None else f"{x:.4g}" for x in p["interval_95"])
    remark = "at a bound" if p["at_bound"] else ("" if p["identifiable"] else "not fixed by the records")
    cells = [p["path"], f"{p['value']:.4g}", p["unit"], f"{low} – {high}", remark]
    return "<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in cells) + "</tr>"


class Diagnosis(_Answer):
    """Which effect is missing, by the screen."""

    @property
    def screen(self) -> pd.DataFrame:
        """The catalogue, most significant first: expected_fall (share of χ²), p_value, visible, sentence, …."""
        return pd.DataFrame(self.answer["screen"]).set_index("effect")

    @property
    def verdict(self) -> str:
        """``nothing_missing``, ``explained``, ``ambiguous`` or ``unexplained``."""
        return str(self.answer["verdict"])

    @property
    def found(self) -> list[str]:
        """Effects that are called for."""
        return list(self.answer["found"])

    @property
    def posterior(self) -> pd.DataFrame | None:
        """How probable each set of effects is, most probable first: ``effects`` (a tuple; empty: none), ``probability``
        that these act and nothing else, ``with_something_else`` that these act and something that the catalogue does
        not hold. ``None`` where the answer has no probabilities. What each effect has alone or with others, and how far all
        that depends on what is believed beforehand, stands in ``answer["posterior"]``."""
        given = self.answer.get("posterior")
        if given is None:
            return None
        sets = [{**s, "effects": tuple(s["effects"])} for s in given["sets"]]
        frame = pd.DataFrame(sets, columns=["effects", "probability", "with_something_else"])
        return frame.sort_values("probability", ascending=False, kind="stable", ignore_index=True)

    def plot(self, ax: Any = None) -> Any:
        """Expected fall of χ² of the ten most promising effects; matplotlib axes."""
        shown, ax = self.screen["expected_fall"].nlargest(10)[::-1], _axes(ax)
        ax.barh(shown.index, shown.to_numpy(), color="#0072B2")
        ax.set(xlabel="expected fall of χ² (share)", title=self.answer["specimen"])
        return ax

    def __repr__(self) -> str:
        return f"<fct.{type(self).__name__} {self.answer['specimen']}: {self.verdict}, {self.found}>"


class Discovery(Diagnosis):
    """The end of a search; ``fit`` is the model it chose, on the file's mesh."""

    def __init__(self, answer: dict[str, Any], fit: Fit | None) -> None:
        super().__init__(answer)
        self.fit = fit

    @property
    def averaged(self) -> pd.DataFrame | None:
        """Values of tissue and tear averaged over what may be missing, each set of effects with its probability, by path, or
        by name for means along the tear (``gc``, ``sigma_c``): value (the median), unit, low_95, high_95. ``None`` where
        the answer has none."""
        given = self.answer.get("averaged")
        if given is None:
            return None
        rows = [
            {"path": path, "value": v["value"], "unit": v["unit"], "low_95": low, "high_95": high}
            for values in (given["path_means"], given["parameters"])
            for path, v in values.items()
            for low, high in [v["interval_95"]]
        ]
        return pd.DataFrame(rows, columns=["path", "value", "unit", "low_95", "high_95"]).set_index("path")

    @property
    def ladder(self) -> pd.DataFrame:
        """Accepted models, base first: effects, parameters, rms_N, reduced_chi2, bic."""
        return pd.DataFrame(self.answer["ladder"]).drop(columns="values")


class Simulation(_Answer):
    """Forward runs."""

    @property
    def tests(self) -> Curves:
        """By test: ``time_s``, ``displacement_mm``, ``force_N`` and what a camera would see (mm)."""
        out = {}
        for name, t in self.answer["tests"].items():
            rows = len(t["time_s"])
            numbers = {k: v for k, v in t.items() if isinstance(v, list) and len(v) == rows and _are_numbers(v)}
            out[name] = pd.DataFrame({k: np.asarray(v, dtype=float) for k, v in numbers.items()})
        return out

    def plot(self, ax: Any = None) -> Any:
        """Force (N) against displacement (mm) of every test; matplotlib axes."""
        ax = _axes(ax)
        for name, curve in self.tests.items():
            ax.plot(curve["displacement_mm"], curve["force_N"], label=name)
        ax.set(xlabel="displacement (mm)", ylabel="force (N)")
        ax.legend()
        return ax


def _are_numbers(values: list[Any]) -> bool:
    return all(v is None or isinstance(v, (int, float)) for v in values)


class Ladder:
    """Fits of one specimen side by side, by number of effects."""

    def __init__(self, fits: tuple[Fit, ...]) -> None:
        self.fits = sorted(fits, key=lambda f: (len(f.effects), -f.answer["rms_N"]))

    @property
    def frame(self) -> pd.DataFrame:
        """effects, bulk_law, interface_law, parameters, rms_N, reduced_chi2, reduced_chi2_total, held_out_rms_N, bic."""
        keys = ("rms_N", "reduced_chi2", "reduced_chi2_total", "held_out_rms_N", "bic")
        rows = [
            {
                "effects": " + ".join(f.effects) or "none",
                "bulk_law": f.answer["laws"]["bulk"],
                "interface_law": f.answer["laws"].get("interface"),
                "parameters": len(f.answer["parameters"]),
                **{k: math.nan if f.answer[k] is None else f.answer[k] for k in keys},
            }
            for f in self.fits
        ]
        return pd.DataFrame(rows)

    def plot(self, ax: Any = None) -> Any:
        """The staircase of the rms misfit (N); matplotlib axes."""
        frame, ax = self.frame, _axes(ax)
        ax.bar(frame["effects"], frame["rms_N"], color="#D55E00")
        ax.set(ylabel="rms misfit (N)", title=self.fits[0].answer["specimen"])
        return ax

    def _repr_html_(self) -> str:
        return str(self.frame.to_html(index=False))


def ladder(*fits: Fit) -> Ladder:
    """The ladder of some fits of one specimen."""
    names = {f.answer["specimen"] for f in fits}
    if len(names) != 1:
        from ._fct import InputError

        raise InputError(f"a ladder is of one specimen; these are of {sorted(names) or 'none'}")
    return Ladder(fits)
