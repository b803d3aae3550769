"""The package as such: stubs, docstrings, the example in the module's own words."""

import doctest
import importlib
import inspect
import pathlib
import subprocess
import sys

import pytest

import fct

HERE = pathlib.Path(__file__).resolve().parents[1]


def test_the_examples_in_docstrings_run():
    assert doctest.testmod(fct).failed == 0 and doctest.testmod(fct).attempted > 0


def test_types_are_checked():
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy"], cwd=HERE, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_names_what_is_there():
    engine = importlib.import_module("fct._fct")
    stub = (HERE / "fct/_fct.pyi").read_text()
    for name in dir(engine):
        if not name.startswith("__") or name == "__version__":
            assert f"def {name}(" in stub or f"class {name}(" in stub or f"{name}:" in stub, name


def test_every_name_has_its_words():
    for name in fct.__all__:
        thing = getattr(fct, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert inspect.getdoc(thing), name
