"""Identify, diagnose, discover, simulate."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from . import _fct
from .case import Model, Specimen, on_disk
from .results import Curves, Diagnosis, Discovery, Fit, Simulation

Case = Specimen | str | os.PathLike[str]
Told = bool | Callable[[str], object] | None


@dataclass(frozen=True)
class Problem:
    """A specimen with a model, ready to be identified: what :meth:`Fit.add` gives."""

    specimen: Case
    model: Model | None = None

    def identify(self, *, threads: int | None = None, progress: Told = None) -> Fit:
        """As :func:`identify`."""
        return identify(self.specimen, self.model, threads=threads, progress=progress)

    def discover(self, *, threads: int | None = None, progress: Told = None) -> Discovery:
        """As :func:`discover`."""
        return discover(self.specimen, self.model, threads=threads, progress=progress)


class _Progress:
    """A callback, or a bar of tqdm that shows the last remark; nothing without either."""

    def __init__(self, told: Told, title: str) -> None:
        self.bar: Any = None
        self.call: Callable[[str], object] | None = None
        if callable(told):
            self.call = told
        elif told:
            from tqdm.auto import tqdm

            self.bar = tqdm(desc=title, bar_format="{desc}: {postfix} [{elapsed}]")
            self.call = self._show

    def _show(self, text: str) -> None:
        self.bar.set_postfix_str(text)

    def __enter__(self) -> Callable[[str], object] | None:
        return self.call

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.close()


def _frame(columns: list[tuple[str, bytes]]) -> pd.DataFrame:
    return pd.DataFrame({name: np.frombuffer(raw) for name, raw in columns}, copy=False)


def _curves(curves: list[_fct._Curve]) -> Curves:
    out = {}
    for test, columns, segments, _ in curves:
        frame = _frame(columns)
        if segments:
            frame["segment"] = segments
        out[test] = frame
    return out


def _fit(answer: str, curves: list[_fct._Curve], specimen: Case, model: Model | None) -> Fit:
    jacobian = {test: _frame(slopes) for test, _, _, slopes in curves}
    return Fit(json.loads(answer), _curves(curves), jacobian, specimen, model)


def check(specimen: Case, model: Model | None = None) -> str:
    """The resolved configuration with every default, as TOML. Raises ``InputError`` with all that is wrong."""
    with on_disk(specimen, model) as file:
        return _fct.check(file)[0]


def effects() -> pd.DataFrame:
    """The catalogue of effects: name, site, summary, law, reference."""
    cards = json.loads(_fct.effects())
    return pd.DataFrame(cards).drop(columns="parameters").set_index("name")


def identify(
    specimen: Case | Problem,
    model: Model | None = None,
    *,
    threads: int | None = None,
    progress: Told = None,
) -> Fit:
    """The paper's inverse analysis: bulk from the intact strip, then Gc (N/mm) and σc (MPa) along the tear.

    ``specimen``: a :class:`Specimen`, or the path of a specimen or config file. ``threads``: default one per core; the
    answer does not depend on it. ``progress``: ``True`` for a bar (tqdm), or a function that is called with a
    text. Ctrl-C stops it within a second: ``fct.Interrupted`` has the best values so far in ``best``.
    """
    if isinstance(specimen, Problem):
        model = specimen.model
        specimen = specimen.specimen
    with on_disk(specimen, model) as file, _Progress(progress, "identify") as told:
        answer, curves = _fct.identify(file, threads, told)
    return _fit(answer, curves, specimen, model)


def diagnose(fit: Fit, *, threads: int | None = None, progress: Told = None) -> Diagnosis:
    """Which effect the model of a fit lacks: the catalogue screened at the identified values."""
    values = [(p["path"], p["value"]) for p in fit.answer["parameters"]]
    with on_disk(fit.specimen, fit.model) as file, _Progress(progress, "diagnose") as told:
        return Diagnosis(json.loads(_fct.diagnose(file, values, threads, told)))


def discover(
    specimen: Case | Problem | Fit,
    model: Model | None = None,
    *,
    threads: int | None = None,
    progress: Told = None,
) -> Discovery:
    """The whole loop: effects are added until the records are explained, or honestly not. Minutes to an hour."""
    if isinstance(specimen, (Problem, Fit)):
        model = specimen.model
        specimen = specimen.specimen
    with on_disk(specimen, model) as file, _Progress(progress, "discover") as told:
        answer, last, curves = _fct.discover(file, threads, told)
    fit = None if last is None else _fit(last, curves, specimen, model)
    return Discovery(json.loads(answer), fit)


def simulate(
    specimen: Case,
    model: Model | None = None,
    *,
    protocol: list[dict[str, float]] | None = None,
    threads: int | None = None,
    progress: Told = None,
) -> Simulation:
    """Forward runs at the model's values: time (s), displacement (mm), force (N), energies (N mm) of every test.

    ``protocol`` replaces what is done in every test of a :class:`Specimen`, its records included.
    """
    if protocol is not None:
        if not isinstance(specimen, Specimen):
            raise _fct.InputError("`protocol` goes with a fct.Specimen; a file has its own")
        specimen = _with_protocol(specimen, protocol)
    with on_disk(specimen, model) as file, _Progress(progress, "simulate") as told:
        return Simulation(json.loads(_fct.simulate(file, threads, told)))


def _with_protocol(specimen: Specimen, protocol: list[dict[str, float]]) -> Specimen:
    from dataclasses import replace

    from .case import Test
    from .records import Record

    tests = [Test(t.kind, t) if isinstance(t, Record) else t for t in specimen.tests]
    return replace(specimen, tests=[replace(t, record=None, protocol=protocol) for t in tests])
