"""Records: what a testing machine measured."""

from __future__ import annotations

import csv
import io
import json
import os
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from . import _fct
from ._fct import InputError


def table(text: str) -> pd.DataFrame:
    """A CSV text as a frame: numbers to the last bit, empty cells of numbers as NaN; lines after ``#`` are left out."""
    rows = list(csv.reader(line for line in io.StringIO(text) if not line.startswith("#")))
    head, body = (rows[0], rows[1:]) if rows else ([], [])
    return pd.DataFrame({name: _column([row[i] for row in body]) for i, name in enumerate(head)})


def _column(cells: list[str]) -> Any:
    try:
        return np.array([float(c) if c else np.nan for c in cells])
    except ValueError:
        return cells


@dataclass(frozen=True)
class Record:
    """One test's record.

    ``csv`` is the canonical text: ``time_s,displacement_mm,force_N`` and what else was measured
    (``grip_displacement_mm``, ``tear_front_mm``, ``width_change_mm``, ``segment``; ``displacement_x_mm``, ``force_x_N``
    of a biaxial test). ``kind`` is the experiment (``"uniaxial"``, ``"tearing"``, ``"biaxial"`` …), if it is known. Two records of the same text are equal.
    """

    csv: str
    kind: str = ""
    name: str = ""
    reading: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)

    @property
    def frame(self) -> pd.DataFrame:
        """The columns, in the units of their names (s, mm, N)."""
        return table(self.csv)

    def __len__(self) -> int:
        """Rows."""
        return len(self.frame)

    def __repr__(self) -> str:
        what = " ".join(w for w in (self.kind, self.name) if w) or "record"
        return f"<fct.Record {what}: {len(self)} rows>"


def read_record(
    source: Any = None,
    *,
    kind: str = "",
    time_s: Any = None,
    displacement_mm: Any = None,
    force_N: Any = None,
    **choices: Any,
) -> Record:
    """Reads a record.

    ``source`` is a file of a testing machine, as ``fct import`` reads it (``choices`` are its flags:
    ``decimal=","``, ``units="force=kN"``, ``rate="3mm/min"``; what a file leaves open is an error that names the
    flag), or a DataFrame, or anything with ``__arrow_c_stream__`` whose columns are named as a record's. Or give the
    arrays ``time_s``, ``displacement_mm`` and ``force_N``; further arrays by name (``tear_front_mm=...``).

    Raises ``fct.InputError`` with the text of the command: file, row, column, what was expected.
    """
    if source is None:
        columns = {"time_s": time_s, "displacement_mm": displacement_mm, "force_N": force_N, **choices}
        missing = [name for name, x in columns.items() if x is None]
        if missing:
            raise InputError(f"a record of arrays lacks {', '.join(missing)}")
        return _of_columns({name: np.asarray(x) for name, x in columns.items()}, kind)
    if isinstance(source, (str, os.PathLike)):
        return _of_file(Path(source), kind, choices)
    if choices:
        raise InputError(f"{', '.join(choices)}: flags are for files; name the columns of a table as a record's")
    if isinstance(source, pd.DataFrame):
        return _of_columns({str(name): source[name].to_numpy() for name in source.columns}, kind)
    if hasattr(source, "__arrow_c_stream__"):
        try:
            import pyarrow
        except ImportError as e:
            raise InputError("a table of Arrow columns needs pyarrow: pip install pyarrow") from e
        table = pyarrow.table(source)
        return _of_columns({name: table[name].to_numpy() for name in table.column_names}, kind)
    raise InputError(f"expected a file, a DataFrame or arrays, not {type(source).__name__}")


def _of_file(path: Path, kind: str, choices: dict[str, Any]) -> Record:
    flags = [(name.replace("_", "-"), str(value)) for name, value in choices.items()]
    tests, reading = _fct.import_record(path, flags, kind)
    if len(tests) != 1:
        raise InputError(f"{path}: {len(tests)} tests in one file; import them with `fct import`")
    name, _, text = tests[0]
    return Record(text, kind, name or path.stem, json.loads(reading))


def _of_columns(columns: dict[str, np.ndarray[Any, Any]], kind: str) -> Record:
    lengths = {name: len(x) for name, x in columns.items()}
    if len(set(lengths.values())) > 1:
        raise InputError(f"the columns have different lengths: {lengths}")
    frame = pd.DataFrame(columns)
    # The shortest text that reads back the same double.
    text = frame.to_csv(index=False, lineterminator="\n")
    try:
        _check(text)
    except InputError as e:
        raise _of_header(e, columns) from None
    return Record(text, kind)


def _of_header(error: InputError, columns: Iterable[str]) -> InputError:
    """What is wrong with the columns of a table: there is no file to point into, and none to import."""
    wrong = [f for f in error.faults if f.get("line") == 1]
    if not wrong:
        return error
    said = "\n".join(f"  {f['message']}" + (f" ({f['help']})" if f.get("help") else "") for f in wrong)
    out = InputError(f"the table has the columns {', '.join(columns) or '(none)'}:\n{said}")
    out.faults = wrong
    return out


def _check(text: str) -> None:
    """Faults of the rows now, not when the record is used: by the reader of all records."""
    with tempfile.TemporaryDirectory(prefix="fct-") as folder:
        Path(folder, "record.csv").write_text(text, encoding="utf-8")
        specimen = Path(folder, "specimen.toml")
        # What is measured along x is a biaxial test's.
        kind = "biaxial" if "force_x_N" in text.split("\n", 1)[0] else "uniaxial"
        specimen.write_text(
            "[geometry]\nlength_mm = 10.0\nwidth_mm = 6.0\nthickness_mm = 1.0\n"
            f'[[tests]]\nkind = "{kind}"\ndata = "record.csv"\n',
            encoding="utf-8",
        )
        _fct.check(specimen)
