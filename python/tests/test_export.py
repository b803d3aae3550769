"""The exported law in FElupe, on one element: its forces are ours."""

import subprocess
import sys

import pytest
from conftest import command


def test_felupe_computes_our_forces(folder):
    pytest.importorskip("felupe")
    pytest.importorskip("tensortrax")
    command(folder, "identify", "fit.toml", "--out", "exported")
    answer = command(folder, "export", "felupe", "exported", "--out", "cube.py")
    assert len(answer["stretch_and_force_N"]) == 10
    done = subprocess.run([sys.executable, "cube.py"], cwd=folder, capture_output=True, text=True)
    print(done.stdout)
    assert done.returncode == 0, done.stdout + done.stderr


def test_decks_that_were_not_run_say_so(folder):
    command(folder, "identify", "fit.toml", "--out", "decks")
    for program, ending in (("abaqus", "inp"), ("febio", "feb")):
        command(folder, "export", program, "decks", "--out", f"cube.{ending}")
        assert "NOT RUN THERE" in (folder / f"cube.{ending}").read_text()
    import xml.etree.ElementTree as tree

    assert tree.parse(folder / "cube.feb").getroot().tag == "febio_spec"
