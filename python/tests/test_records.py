"""Records from files, tables and arrays."""

import pickle

import numpy as np
import pandas as pd
import pytest

import fct


@pytest.fixture
def frame():
    time = np.linspace(0, 10, 21)
    return pd.DataFrame({"time_s": time, "displacement_mm": time / 10, "force_N": np.sin(time / 7) / 3})


def test_tables_and_arrays_give_the_same_record(frame):
    record = fct.read_record(frame, kind="uniaxial")
    arrays = {name: frame[name].to_numpy() for name in frame}
    assert record == fct.read_record(kind="uniaxial", **arrays)
    assert np.array_equal(record.frame["force_N"], frame["force_N"])
    assert len(record) == 21 and pickle.loads(pickle.dumps(record)) == record


def test_arrow_tables_are_read(frame):
    pyarrow = pytest.importorskip("pyarrow")
    assert fct.read_record(pyarrow.Table.from_pandas(frame)) == fct.read_record(frame)


def test_a_testing_machine_s_file_is_read(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("Zeit;Weg;Kraft\ns;mm;kN\n0,0;0,000;0,0001\n0,5;0,025;0,0012\n1,0;0,050;0,0025\n")
    record = fct.read_record(file)
    assert list(record.frame["force_N"]) == [0.1, 1.2, 2.5]
    open_ = tmp_path / "b.csv"
    open_.write_text("Time [s],Extension [mm],Load\n0,0,0.1\n1,0.05,1.2\n2,0.1,2.5\n")
    with pytest.raises(fct.InputError, match="units"):
        fct.read_record(open_)
    assert list(fct.read_record(open_, units="force=N").frame["force_N"]) == [0.1, 1.2, 2.5]


def test_what_is_no_record_is_an_error(frame):
    with pytest.raises(fct.InputError, match="lacks force_N"):
        fct.read_record(time_s=[0, 1], displacement_mm=[0, 1])
    with pytest.raises(fct.InputError, match="lengths"):
        fct.read_record(time_s=[0, 1], displacement_mm=[0, 1], force_N=[0])
    with pytest.raises(fct.InputError, match="record.csv:3"):
        fct.read_record(time_s=[0, 0, 1], displacement_mm=[0, 1, 2], force_N=[0, 1, 2])
    with pytest.raises(fct.InputError, match="not int"):
        fct.read_record(3)
    strip = fct.Specimen(8, 6, 0.8, tests=[fct.read_record(frame)])
    with pytest.raises(fct.InputError, match="kind"):
        fct.check(strip)


def test_a_table_with_wrong_columns_says_which_and_what_was_found(frame):
    renamed = frame.rename(columns={"force_N": "Load", "time_s": "time"}).assign(temperature=37.0)
    with pytest.raises(fct.InputError) as error:
        fct.read_record(renamed)
    said = str(error.value)
    assert said.startswith("the table has the columns time, displacement_mm, Load, temperature:\n")
    for part in ("`time`", "`time_s`", "`Load`", "`temperature`", "`force_N`"):
        assert part in said, said
    assert "fct import" not in said and {f["line"] for f in error.value.faults} == {1}
    with pytest.raises(fct.InputError, match="the table has the columns time_s, displacement_mm:\n.*force_N"):
        fct.read_record(frame[["time_s", "displacement_mm"]])
    # What is wrong with a row is told with its line.
    holes = frame.assign(force_N=frame["force_N"].where(frame.index != 4))
    with pytest.raises(fct.InputError, match="record.csv:6:.*force_N"):
        fct.read_record(holes)
