"""What was tested, and the model of it."""

from __future__ import annotations

import contextlib
import copy
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import _toml
from ._fct import InputError
from .records import Record

try:
    import tomllib
except ImportError:  # Python 3.10
    tomllib = None  # type: ignore[assignment]


@dataclass(frozen=True)
class Test:
    """One test on the piece.

    ``kind``: ``"uniaxial"`` (intact strip) or ``"tearing"`` (strip with the cut). Either a ``record``, or a
    ``protocol``: ``[{"to_mm": 2.0, "rate_mm_per_s": 0.05}, {"hold_s": 60.0}]``. ``keys``: whatever else a
    ``[[tests]]`` block of a specimen file takes (``ends="sliding"``, ``force_sd_N=0.002``, ``rest_s=600.0``).
    """

    __test__ = False  # Not one of pytest's.

    kind: str
    record: Record | None = None
    protocol: Sequence[Mapping[str, float]] | None = None
    name: str = ""
    keys: Mapping[str, Any] = field(default_factory=dict)

    def _table(self, k: int) -> tuple[dict[str, Any], str | None]:
        out: dict[str, Any] = {"kind": self.kind, **self.keys}
        if self.name:
            out["name"] = self.name
        if self.record is not None:
            out["data"] = f"test-{k + 1}.csv"
        if self.protocol is not None:
            out["protocol"] = [dict(leg) for leg in self.protocol]
        return out, None if self.record is None else self.record.csv


@dataclass(frozen=True)
class Specimen:
    """A strip and its tests, in the order in which they were done.

    ``length_mm`` along the load between the clamps, ``width_mm`` along the tear, ``thickness_mm``, ``cut_mm`` the
    initial cut from the edge x = 0. ``tests``: :class:`Test`, or records whose ``kind`` is known. ``geometry``:
    whatever else ``[geometry]`` takes. ``provenance`` stands in every report.
    """

    length_mm: float
    width_mm: float
    thickness_mm: float
    cut_mm: float = 0.0
    tests: Sequence[Test | Record] = ()
    name: str = "specimen"
    provenance: str = ""
    geometry: Mapping[str, Any] = field(default_factory=dict)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Writes ``specimen.toml`` and its records into a folder that is there; returns the file."""
        return self._write(Path(folder))

    def _write(self, folder: Path) -> Path:
        tests = []
        for k, test in enumerate(self.tests):
            if isinstance(test, Record):
                if not test.kind:
                    raise InputError(f"test {k + 1}: the kind of the record is not known; fct.Test(kind, record)")
                test = Test(test.kind, test)
            table, csv = test._table(k)
            tests.append(table)
            if csv is not None:
                folder.joinpath(table["data"]).write_text(csv, encoding="utf-8")
        sizes = {"length_mm": float(self.length_mm), "width_mm": float(self.width_mm)}
        sizes |= {"thickness_mm": float(self.thickness_mm), "cut_mm": float(self.cut_mm)}
        content: dict[str, Any] = {"name": self.name}
        if self.provenance:
            content["provenance"] = self.provenance
        content |= {"geometry": {**sizes, **self.geometry}, "tests": tests}
        path = folder / "specimen.toml"
        path.write_text(_toml.table(content), encoding="utf-8")
        return path


class Model:
    """Laws, mesh, effects and settings: what a config file holds besides its specimen.

    Sections are tables with the keys of the files: ``Model(areas=3, bulk={"mu_kPa": 5.1},
    interface={"gc_N_per_mm": {"start": 0.2, "max": 2.0}}, effects={"drift": {}}, mesh={"divisions": [8, 20, 2]})``.
    ``fct schema`` and the book's page of keys list them all.
    """

    def __init__(
        self,
        areas: int | None = None,
        *,
        effects: Mapping[str, Mapping[str, Any]] | Sequence[str] = (),
        **sections: Mapping[str, Any],
    ) -> None:
        content: dict[str, Any] = {name: dict(table) for name, table in sections.items()}
        if areas is not None:
            content.setdefault("interface", {})["areas"] = int(areas)
        if effects:
            named = effects if isinstance(effects, Mapping) else {name: {} for name in effects}
            content["effects"] = {name: dict(table) for name, table in named.items()}
        self._content = content

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Model:
        """The model of a config file; its specimen is left out."""
        if tomllib is None:
            raise InputError("reading a config into a Model needs Python 3.11 or newer")
        try:
            content = tomllib.loads(Path(path).read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as e:
            raise InputError(f"{path}: {e}") from e
        model = cls()
        beside = ("specimen", "geometry", "tests", "name", "provenance", "parent")
        model._content = {k: v for k, v in content.items() if k not in beside}
        return model

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of its effects."""
        return tuple(self._content.get("effects", {}))

    def add(self, effect: str, **parameters: Any) -> Model:
        """The model with an effect added, parameters as its card's keys (``c_N_per_s=1e-4``); this one stays."""
        if effect in self.effects:
            raise InputError(f"effect `{effect}` is already in the model")
        other = Model()
        other._content = copy.deepcopy(self._content)
        other._content.setdefault("effects", {})[effect] = dict(parameters)
        return other

    def drop(self, effect: str) -> Model:
        """The model with an effect taken away; this one stays."""
        if effect not in self.effects:
            raise InputError(f"effect `{effect}` is not in the model")
        other = Model()
        other._content = copy.deepcopy(self._content)
        del other._content["effects"][effect]
        return other

    @property
    def toml(self) -> str:
        """The text of a config file without its specimen."""
        return _toml.table(self._content)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self.toml)

    def __repr__(self) -> str:
        inside = ", ".join(f"{k}={v!r}" for k, v in self._content.items())
        return f"fct.Model({inside})"


@contextlib.contextmanager
def on_disk(specimen: Specimen | str | os.PathLike[str], model: Model | None) -> Iterator[Path]:
    """A file that the engine reads: the given one, or one in a folder that goes afterwards."""
    given = isinstance(specimen, (str, os.PathLike))
    if given and model is None:
        yield Path(specimen)  # type: ignore[arg-type]
        return
    with tempfile.TemporaryDirectory(prefix="fct-") as folder:
        if given:
            file = Path(specimen).resolve()  # type: ignore[arg-type]
        else:
            assert isinstance(specimen, Specimen)
            file = specimen._write(Path(folder))
            if model is None:
                yield file
                return
        config = Path(folder, "config.toml")
        head = _toml.table({"specimen": str(file)})
        config.write_text(head + (model.toml if model else ""), encoding="utf-8")
        yield config


def apart(specimen: Specimen | str | os.PathLike[str], model: Model | None) -> tuple[Any, Model]:
    """Specimen and model of a case apart, so that the model can be changed."""
    if model is not None or isinstance(specimen, Specimen):
        return specimen, model or Model()
    path = Path(specimen)
    own = Model.from_file(path)
    assert tomllib is not None
    named = tomllib.loads(path.read_text(encoding="utf-8")).get("specimen")
    if named is not None:
        return path.parent / named, own
    if own._content:
        raise InputError(f"{path}: geometry and model stand in one file; put [geometry] and [[tests]] in a specimen file")
    return path, own
