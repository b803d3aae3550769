"""Studies of many specimens, on any executor.

A task is done by whichever process claims it first, and is never done again: results are files in the study's folder,
the same that ``fct campaign run`` makes and reads. A lost worker costs its tasks only.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pandas as pd

from . import _fct
from .records import table

Study = str | os.PathLike[str]


@dataclass(frozen=True)
class Report:
    """What a study says together."""

    answer: dict[str, Any]
    """The document of ``fct campaign report --json``."""
    page: str
    """The study page, one self-contained HTML file."""
    methods: str
    """A paragraph for a methods section, with citations."""
    tables: dict[str, str]
    """``specimens.csv`` and ``groups.csv``."""

    def _frame(self, name: str) -> pd.DataFrame:
        return table(self.tables[name])

    @property
    def specimens(self) -> pd.DataFrame:
        """A row per model, specimen and quantity: value, std_error, low_95, high_95, counted, left_out, …."""
        return self._frame("specimens.csv")

    @property
    def groups(self) -> pd.DataFrame:
        """A row per model, group and quantity: mean, interval, scatter between and within specimens."""
        return self._frame("groups.csv")

    def _repr_html_(self) -> str:
        return str(self.groups.to_html(index=False))


def plan(study: Study) -> dict[str, Any]:
    """Plans a study: specimens, models, tasks, rows that cannot be used (``wrong``), and its ``folder``."""
    folder, text = _fct.campaign_plan(study)
    return {**json.loads(text), "folder": str(folder)}


def status(study: Study) -> dict[str, Any]:
    """How the tasks stand at this moment: done, failed, running, waiting, set_aside, and what to look at."""
    return dict(json.loads(_fct.campaign_status(study)))


def report(study: Study) -> Report:
    """What the results say together, as far as they are there."""
    answer, page, methods, tables = _fct.campaign_report(study)
    return Report(json.loads(answer), page, methods, dict(tables))


def pooled(values: Iterable[float], std_errors: Iterable[float]) -> dict[str, Any]:
    """A random-effects model (REML, Hartung–Knapp interval) over values with their standard errors, as the study page
    has it: mean, std_error, interval_95, between_sd, within_sd, i2, q, p_q, prediction_95, weights; units as given."""
    return dict(json.loads(_fct.campaign_pooled([float(x) for x in values], [float(x) for x in std_errors])))


def attempt(folder: str, key: str, threads: int | None = 1) -> str:
    """Tries one task of a planned study; what became of it: done, failed, before, elsewhere, set_aside, waits."""
    return _fct.campaign_attempt(folder, key, threads)


def run(
    study: Study,
    executor: Executor | None = None,
    *,
    workers: int | None = None,
    threads: int = 1,
    patience_s: float = 600.0,
    progress: bool = False,
) -> dict[str, Any]:
    """Does all tasks of a study, and returns its status.

    ``executor``: anything with the interface of ``concurrent.futures`` whose workers see the study's folder: Dask's
    ``client.get_executor()``, ``mpi4py.futures``. Default: so many processes on this machine. ``threads`` per task.
    A worker that is lost costs its task only; a task that loses three is set aside. ``patience_s``: how long to wait
    for tasks that others work on.
    """
    planned = plan(study)
    own = executor is None
    pool: Executor = executor if executor is not None else _processes(workers)
    bar = _bar(progress, len(planned["tasks"]))
    try:
        # Repeats wait for the fit that they repeat.
        for batch in _batches(planned["tasks"]):
            pool = _all(pool, own, workers, planned["folder"], batch, threads, patience_s, bar)
    finally:
        if bar is not None:
            bar.close()
        if own:
            pool.shutdown(cancel_futures=True)
    return status(study)


def _batches(tasks: list[dict[str, Any]]) -> Iterable[list[str]]:
    first = [t["key"] for t in tasks if "base" not in t]
    again = [t["key"] for t in tasks if "base" in t]
    return [batch for batch in (first, again) if batch]


def _all(
    pool: Executor,
    own: bool,
    workers: int | None,
    folder: str,
    keys: list[str],
    threads: int,
    patience_s: float,
    bar: Any,
) -> Executor:
    """Does these tasks; returns the pool, which is a new one where one broke."""
    left = list(keys)
    losses = 0
    begun = time.monotonic()
    while left:
        futures: dict[Future[str], str] = {}
        later: list[str] = []
        try:
            for key in left:
                futures[pool.submit(attempt, folder, key, threads)] = key
            open_ = set(futures)
            while open_:
                ended, open_ = wait(open_, return_when=FIRST_COMPLETED)
                for future in ended:
                    word = _word(future)
                    if word in ("elsewhere", "waits", "lost"):
                        later.append(futures[future])
                    elif bar is not None:
                        bar.update()
        except BrokenExecutor:
            losses += 1
            # Whose result is there is not done again: all of them may be asked once more.
            if not own or losses > 3 * len(keys) + 10:
                raise
            pool.shutdown(wait=False)
            pool = _processes(workers)
            continue
        left = later
        if left:
            if time.monotonic() - begun > patience_s:
                break
            time.sleep(0.5)
    return pool


def _word(future: Future[str]) -> str:
    """What became of a task. A worker that was lost on the way is told by its executor's own exception."""
    try:
        return future.result()
    except (_fct.FctError, BrokenExecutor):
        raise
    except Exception as e:
        if "Killed" in type(e).__name__ or "Cancelled" in type(e).__name__ or "Lost" in type(e).__name__:
            return "lost"
        raise


def _processes(workers: int | None) -> ProcessPoolExecutor:
    # A forked process would have the threads of this one's engine half alive.
    return ProcessPoolExecutor(workers or os.cpu_count(), mp_context=get_context("spawn"))


def _bar(progress: bool, total: int) -> Any:
    if not progress:
        return None
    from tqdm.auto import tqdm

    return tqdm(total=total, unit="task")


def write_page(study: Study, path: Study) -> None:
    """Writes the study page."""
    Path(path).write_text(report(study).page, encoding="utf-8")
