"""An effect of one's own as a Python function, for trying out an idea before it is built."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from ._fct import ComputeError, InputError
from .results import Curves, Fit, _axes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SITES = ("sensor", "load_train")
Law = Callable[..., Any]


@dataclass(frozen=True)
class Trial:
    """What a law of one's own makes of a fit."""

    fit: Fit
    values: dict[str, float]
    """The law's parameters as fitted."""
    std_errors: dict[str, float]
    """Their standard errors as if the noise had no memory and the mesh no error: smaller than what a fit would say."""
    shift: pd.Series[float]
    """How far the model's own parameters went, in standard errors of the fit. Far beyond 3, the linear response is
    not to be trusted."""
    curves: Curves
    """By test: ``time_s``, ``displacement_mm``, ``force_measured_N``, ``force_model_N`` (with the law), ``residual_N``."""
    chi2_before: float
    """Sum of squared residuals over the noise's variance, without the law."""
    chi2_after: float
    """With it, the model's parameters refitted in their linear response."""

    @property
    def fall(self) -> float:
        """Share of χ² that goes with the law."""
        return 1 - self.chi2_after / self.chi2_before

    def plot(self, test: str | None = None, ax: Any = None) -> Any:
        """Residual (N) against time (s) with and without the law, of one test (default: the last); matplotlib axes."""
        name = test or list(self.curves)[-1]
        ax, before, after = _axes(ax), self.fit.curves[name], self.curves[name]
        ax.plot(before["time_s"], before["residual_N"], ".", color="#777780", ms=3, label="without the law")
        ax.plot(after["time_s"], after["residual_N"], ".", color="#D55E00", ms=3, label="with it")
        ax.set(xlabel="time (s)", ylabel="record − model (N)", title=f"{self.fit.answer['specimen']}: {name}")
        ax.legend()
        return ax


def try_law(fit: Fit, law: Law, start: Mapping[str, float], *, site: str = "sensor") -> Trial:
    """Fits a law of one's own to what a fit leaves, together with the model's parameters in their linear response.

    ``law(curve, **parameters)`` gets a test's curve (``time_s``, ``displacement_mm``, ``force_N`` of the model) and
    returns one number per row. At the site ``"sensor"`` it is the force that the cell shows (N); at ``"load_train"``
    the part of the grips' way that the specimen does not get (mm), which is taken off the displacement within each
    segment of the protocol: exact where the model's force hangs on displacement alone, a first guess where it has a
    memory. ``start``: first values of the law's parameters; their size is the scale they are varied on.

    This is a screen, not a fit: what looks good here is worth an effect of its own (see the manual, "An effect of your
    own"), which the whole catalogue is then weighed against.
    """
    if site not in SITES:
        raise InputError(f"`site` is one of {', '.join(SITES)}; found {site!r}")
    if not start:
        raise InputError("`start` names the law's parameters with their first values; it is empty")
    if any(fit.jacobian[n].isna().any(axis=None) or fit.jacobian[n].empty for n in fit.curves):
        raise InputError("this fit has no derivatives of its curves")
    problem = _Problem(fit, law, tuple(start), site)
    begun = np.array([float(v) for v in start.values()])
    scale = np.where(begun == 0, 1.0, np.abs(begun))
    x, covariance = problem.solve(np.concatenate([np.zeros(len(problem.paths)), begun]), scale)
    n = len(problem.paths)
    errors = np.sqrt(np.diag(covariance))[n:]
    std = fit.params["std_error"].reindex(problem.paths).to_numpy()
    return Trial(
        fit=fit,
        values=dict(zip(start, map(float, x[n:]), strict=True)),
        std_errors=dict(zip(start, map(float, errors), strict=True)),
        shift=pd.Series(x[:n] / std, index=problem.paths),
        curves=problem.curves(x),
        chi2_before=float(sum(((c["residual_N"] / problem.sd[t]) ** 2).sum() for t, c in fit.curves.items())),
        chi2_after=float((problem.residuals(x) ** 2).sum()),
    )


class _Problem:
    """Least squares over shifts of the model's parameters, then the law's parameters."""

    def __init__(self, fit: Fit, law: Law, names: tuple[str, ...], site: str) -> None:
        self.fit, self.law, self.names, self.site = fit, law, names, site
        self.paths = list(next(iter(fit.jacobian.values())).columns)
        self.sd = {name: float(fit.answer["tests"][name]["noise_N"]) for name in fit.curves}

    def force(self, test: str, x: Array) -> Array:
        """Force of a test with the law (N)."""
        curve, n = self.fit.curves[test], len(self.paths)
        model = curve["force_model_N"].to_numpy() + self.fit.jacobian[test].to_numpy() @ x[:n]
        seen = pd.DataFrame({"time_s": curve["time_s"], "displacement_mm": curve["displacement_mm"], "force_N": model})
        said = np.asarray(self.law(seen, **dict(zip(self.names, map(float, x[n:]), strict=True))), dtype=float)
        if said.shape != model.shape:
            raise InputError(f"the law returned {said.shape} numbers for the {model.shape[0]} rows of {test}")
        if not np.isfinite(said).all():
            raise ComputeError(f"the law returned what is no number for {test}")
        return said if self.site == "sensor" else _taken_off(curve, model, said)

    def residuals(self, x: Array) -> Array:
        """(record − model) over the noise's standard deviation, of all tests."""
        parts = [(c["force_measured_N"].to_numpy() - self.force(t, x)) / self.sd[t] for t, c in self.fit.curves.items()]
        return np.concatenate(parts)

    def slopes(self, x: Array, steps: Array) -> Array:
        columns = []
        for k, step in enumerate(steps):
            up, down = x.copy(), x.copy()
            up[k] += step
            down[k] -= step
            columns.append((self.residuals(up) - self.residuals(down)) / (2 * step))
        return np.column_stack(columns)

    def solve(self, x: Array, scale: Array) -> tuple[Array, Array]:
        """Levenberg–Marquardt; the answer and its covariance."""
        sizes = np.concatenate([self.fit.params["std_error"].reindex(self.paths).to_numpy(), scale])
        sizes = np.where(np.isfinite(sizes) & (sizes > 0), sizes, 1.0)
        steps, damping = 1e-4 * sizes, 1e-3
        r = self.residuals(x)
        for _ in range(100):
            a = self.slopes(x, steps) * sizes
            gradient, normal = a.T @ r, a.T @ a
            floor = 1e-9 * np.trace(normal) / len(x)
            step = np.linalg.solve(normal + damping * np.diag(np.diag(normal) + floor), -gradient)
            trial = x + sizes * step
            after = self.residuals(trial)
            if (after**2).sum() < (r**2).sum():
                settled = (r**2).sum() - (after**2).sum() < 1e-6
                x, r, damping = trial, after, max(damping / 5, 1e-9)
                if settled:
                    break
            else:
                damping *= 5
                if damping > 1e9:
                    break
        a = self.slopes(x, steps) * sizes
        return x, np.linalg.pinv(a.T @ a) * np.outer(sizes, sizes)

    def curves(self, x: Array) -> Curves:
        out = {}
        for test, curve in self.fit.curves.items():
            frame = curve[["time_s", "displacement_mm", "force_measured_N"]].copy()
            frame["force_model_N"] = self.force(test, x)
            frame["residual_N"] = frame["force_measured_N"] - frame["force_model_N"]
            out[test] = frame
        return out


def _taken_off(curve: pd.DataFrame, force: Array, lost: Array) -> Array:
    """Force at the displacement less what is lost, within each segment; at its ends continued with the last slope."""
    u, out = curve["displacement_mm"].to_numpy(), force.copy()
    segment = curve["segment"] if "segment" in curve else pd.Series("all", index=curve.index)
    # A segment that comes again later is another one.
    for _, rows in curve.groupby((segment != segment.shift()).cumsum().to_numpy()).indices.items():
        here = u[rows]
        order = np.argsort(here, kind="stable")
        knots, first = np.unique(here[order], return_index=True)
        if len(knots) < 2:
            continue
        values, at = force[rows][order][first], here - lost[rows]
        below, above = at < knots[0], at > knots[-1]
        there = np.interp(at, knots, values)
        low = (values[1] - values[0]) / (knots[1] - knots[0])
        high = (values[-1] - values[-2]) / (knots[-1] - knots[-2])
        there[below] = values[0] + low * (at[below] - knots[0])
        there[above] = values[-1] + high * (at[above] - knots[-1])
        out[rows] = there
    return out
