"""Columns of files are read in many dialects; what is missing, odd or can be meant in two ways is refused by name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dse.domain.component import Causality, Component, Interface, Kind, Parameter, Port, Type
from dse.domain.time_series import Interpolation, Missing, Outside, Series, TableFile, TimeSeriesSource
from dse.errors import DseError, Location
from dse.series.samples import Samples, read_samples
from dse.units import parse_unit

WHERE = Location("bench.yaml", 7, 9)
SPEED = Type(Kind.REAL, parse_unit("m/s"))


def read(
    file: Path,
    column: str | int = "v",
    time: str | int = "",
    type_: Type = SPEED,
    outside: Outside = Outside.HOLD,
    missing: Missing = Missing.ERROR,
    stop: float | None = 2.0,
    offset: float = 0.0,
    interpolation: Interpolation | None = None,
    **dialect,
) -> Samples:
    series = Series("u", TableFile(file, **dialect), column, time, interpolation, outside, missing, WHERE)
    parameters = (Parameter("offset", Type(Kind.REAL, parse_unit("s")), offset),)
    interface = Interface("profile", (Port("u", Causality.OUTPUT, type_),))
    (samples,) = read_samples(Component("c", interface, parameters=parameters), TimeSeriesSource((series,), stop))
    return samples


def refused(*args, **kwargs) -> tuple[str, str]:
    """Place and message."""
    with pytest.raises(DseError) as caught:
        read(*args, **kwargs)
    (problem,) = caught.value.problems
    return str(problem.where), f"{problem.what} | {problem.hint}"


@pytest.mark.parametrize(
    ("text", "arguments"),
    [
        ("time,v [km/h]\n0,0\n0.5,18\n2,-36\n", {}),
        ("time;v [km/h]\n0;0\n0,5;18\n2;-36\n", {}),
        ('t,v (km/h)\n"0","0"\n"0,5","18"\n2,-36\n', {}),
        ("\ufeffsep=;\nTime [ms];Speed [kph]\n0;0\n500;18\n2000;-36\n", {"column": "Speed", "time": "Time [ms]"}),
        ("t\tx\tv\ns\tm\tkm/h\n0\t1\t0\n0.5\t\t18\n2\t\t-36\n", {}),
        ("t;v\n[ms];[km/h]\n0;0\n500;18\n2000;-36\n", {}),
        ("# logged by hand\n% t v\n  t     v\n\n0.0  0\n0.5e0  1.8e1\n// end\n2   -36\n", {"column": "v [km/h]"}),
        ("0,0\n0.5,18\n2,-36\n", {"column": "2 [km/h]", "time": 1}),
        ("log of 3 May\nby me\nt|v [km/h]|\n0|0|\n0.5|18|\n2|-36|\n", {"skip_lines": 2}),
        ("time,v [km/h]\n2026-03-01 23:59:59.5,0\n2026-03-02T00:00:00,18\n2026-03-02T00:00:01.500,-36\n", {}),
        ("time,v [km/h]\n2026-03-01T10:00:00Z,0\n2026-03-01T11:00:00.5+01:00,18\n2026-03-01T10:00:02Z,-36\n", {}),
        ("t;v [km/h]\n0,000;0,000\n0,500;18,000\n2,000;-36,000\n", {"decimal": ","}),
        ("t,v [km/h],v [m/s]\n0,0,1\n0.5,18,1\n2,-36,1\n", {"column": "v [km/h]"}),
        ("t,v\n0,0\n0.25,n/a\n0.5,18\n,5\n2,-36\n", {"column": "v [km/h]", "missing": Missing.SKIP}),
    ],
)
def test_a_table_is_read_in_the_dialect_it_is_written_in(tmp_path, text, arguments):
    file = tmp_path / "s.csv"
    file.write_text(text, encoding="utf-8")
    samples = read(file, **arguments)
    assert samples.first + samples.times == pytest.approx([0, 0.5, 2], abs=0)
    assert samples.values.tolist() == [0, 5, -10]


@pytest.mark.parametrize("encoding", ["cp1252", "utf-16", "utf-8-sig"])
def test_headings_are_read_in_usual_encodings(tmp_path, encoding):
    file = tmp_path / "s.csv"
    file.write_bytes("t;Öl [°C]\n0;20\n2;-3\n".encode(encoding))
    samples = read(file, "Öl", type_=Type(Kind.REAL, parse_unit("K")))
    assert samples.values.tolist() == [293.15, 270.15]


T = "t,v [m/s]\n"


@pytest.mark.parametrize(
    ("text", "arguments", "place", "said"),
    [
        (T + "0,0\n1,x\n", {}, "s.csv:3:1", "'x' in 'v [m/s]' is not a number"),
        (T + "0,0\n1,\n", {}, "s.csv:3:1", "no value of 'v [m/s]' in this row | set 'missing: skip'"),
        (T + "0,0\n,1\n", {}, "s.csv:3:1", "no value of 't' in this row"),
        (T + "0,0\n1,nan\n2,nan\n", {}, "s.csv:3:1", "in this row, as in 1 more"),
        (T + "0,0\n1,1e999\n", {}, "s.csv:3:1", "'v [m/s]' is infinite"),
        (T + "0,0\n1,inf\n", {}, "s.csv:3:1", "'inf' in 'v [m/s]' is not a number"),
        (T + "0,0\n1,1_0\n", {}, "s.csv:3:1", "'1_0' in 'v [m/s]' is not a number"),
        (T + "# a\n0,0\n1,1\n1,2\n", {}, "s.csv:5:1", "the time does not advance: 1 s after 1 s | times must increase"),
        (T + "0,0\n2,1\n1,2\n", {}, "s.csv:4:1", "the time goes back: 1 s after 2 s"),
        (T + "0,0\n", {}, "bench.yaml:7:9", "'v [m/s]' has fewer than two samples"),
        (T, {}, "bench.yaml:7:9", "has no row below its headings"),
        ("", {}, "bench.yaml:7:9", "is empty"),
        (T + "0,0\n1,2,3\n", {"separator": ","}, "s.csv:3:1", "3 values, but 2 columns"),
        (T + "0,0\n1,2,3\n", {}, "bench.yaml:7:9", "are separated is not clear | set 'separator"),
        ("t;v\n0,5;1.5\n1,5;2.5\n", {}, "s.csv:2:1", "'0,5' has a comma, other numbers have a point | set 'decimal"),
        ("t;v\n0;1,500\n1;2,500\n", {}, "s.csv:2:1", "the comma in '1,500' may mark decimals or thousands"),
        ("0,1 2,5\n0,2 2,5\n", {"column": 2, "time": 1}, "bench.yaml:7:9", "no unit is given for 'column 2'"),
        ("0,0\n1,2\n", {}, "bench.yaml:7:9", "the column of the time is not clear | name it, as 'time"),
        ("0,0\n1,2\n", {"time": 1}, "bench.yaml:7:9", "the file has no headings | give the number of the column"),
        ("0,0\n1,2\n", {"time": 1, "column": 2}, "bench.yaml:7:9", "state it, as 'column: 2 [m/s]'"),
        ("0,0\n1,2\n", {"time": 1, "column": 3}, "bench.yaml:7:9", "there is no column 3: the file has 2"),
        ("t,w\n0,0\n1,1\n", {}, "bench.yaml:7:9", "there is no column 'v' | possible: t, w"),
        ("t,v,v\n0,0,1\n1,1,1\n", {}, "bench.yaml:7:9", "columns 2 and 3 are both 'v'"),
        ("t,v [m/s],v [km/h]\n0,0,1\n1,1,1\n", {}, "bench.yaml:7:9", "columns 2 and 3 are both 'v'"),
        ("t,v\n0,0\n1,1\n", {}, "bench.yaml:7:9", "no unit is given for 'v' | state it, as 'column: v [m/s]'"),
        ("t,v [m]\n0,0\n1,1\n", {}, "bench.yaml:7:9", "'v [m]' is length, the input is in m/s"),
        ("t,v [m]\n0,0\n1,1\n", {"column": "v [m/s]"}, "bench.yaml:7:9", "'v [m]' is in m, not in m/s"),
        ("t,v [furlongs]\n0,0\n1,1\n", {"column": 2}, "bench.yaml:7:9", "has the unknown unit 'furlongz'"),
        ("t [m],v [m/s]\n0,0\n1,1\n", {}, "bench.yaml:7:9", "'t [m]' is in m, which is not a unit of time"),
        (
            "t,v\n12:30:00,0\n12:30:01,1\n",
            {"column": "v [m/s]"},
            "s.csv:2:1",
            "'12:30:00' is not a time | seconds",
        ),
        (
            "t,v\n5,0\n9,1\n",
            {"column": "v [m/s]"},
            "bench.yaml:7:9",
            "the run from 0 s on never meets",
        ),
        (T + "0,0\n1,1\n", {"offset": 1.0}, "bench.yaml:7:9", "the run from 1 s on never meets it | set where the run"),
        (T + "0,0\n1,1\n", {"outside": Outside.ERROR}, "bench.yaml:7:9", "the run from 0 s to 2 s, and 'outside' is"),
        (T + "1e9,0\n1.1e9,1\n", {"stop": None}, "bench.yaml:7:9", "the run from 0 s on never meets it"),
    ],
)
def test_what_is_wrong_in_a_table_is_told_where_it_stands(tmp_path, monkeypatch, text, arguments, place, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.csv").write_text(text.replace("furlongs", "furlongz"), encoding="utf-8")
    found, message = refused(tmp_path / "s.csv", **arguments)
    assert found == place
    assert said in message


@pytest.mark.parametrize(
    ("type_", "cells", "said"),
    [
        (Type(Kind.INTEGER), "1 1.5", "1.5 in 'v' is not a value of int"),
        (Type(Kind.INTEGER), "1 3000000000", "3e+09 in 'v' is not a value of int"),
        (Type(Kind.BOOLEAN), "0 2", "2 in 'v' is not a value of bool"),
        (Type(Kind.BOOLEAN), "true yes", "'yes' in 'v' is not bool"),
        (Type(Kind.ENUMERATION, items=("eco", "sport")), "eco spurt", "'spurt' in 'v' is not enum[eco, sport]"),
        (Type(Kind.ENUMERATION, items=("eco", "sport")), "0 2", "2 in 'v' is not a value of enum[eco, sport]"),
    ],
)
def test_a_value_that_a_port_does_not_have_is_told_at_its_row(tmp_path, monkeypatch, type_, cells, said):
    monkeypatch.chdir(tmp_path)
    first, second = cells.split()
    (tmp_path / "s.csv").write_text(f"t,v\n0,{first}\n1,{second}\n", encoding="utf-8")
    place, message = refused(tmp_path / "s.csv", type_=type_)
    assert place == "s.csv:3:1"
    assert said in message
    _, message = refused(tmp_path / "s.csv", type_=type_, interpolation=Interpolation.LINEAR)
    assert "between two of its values there is none" in message
    _, message = refused(tmp_path / "s.csv", type_=type_, outside=Outside.ERROR)
    assert "has no value for an error" in message


def test_the_unit_of_a_frequency_is_not_taken_for_that_of_a_speed_of_rotation(tmp_path):
    (tmp_path / "s.csv").write_text("t,n [Hz]\n0,0\n1,1\n", encoding="utf-8")
    _, message = refused(tmp_path / "s.csv", "n", type_=Type(Kind.REAL, parse_unit("rad/s")))
    assert "'n [Hz]' is Hz, the input is in rad/s" in message


def test_a_column_with_too_many_samples_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("dse.series.samples.MOST_SAMPLES", 2)
    (tmp_path / "s.csv").write_text("t,v [m/s]\n0,0\n1,1\n2,1\n", encoding="utf-8")
    assert "has 3 samples, more than 2 | cut out" in refused(tmp_path / "s.csv")[1]
    monkeypatch.setattr("dse.series.samples.MOST_SAMPLES", 3)
    monkeypatch.setattr("dse.series.samples.MOST_NUMBERS", 5)
    with pytest.raises(DseError, match="component 'c' has 6 numbers in its series, more than 5"):
        read(tmp_path / "s.csv")
    monkeypatch.setattr("dse.series.csv_table._MOST_LINES", 3)
    assert refused(tmp_path / "s.csv")[1] == "s.csv has more than 3 lines | cut out what is used"
    monkeypatch.setattr("dse.series.csv_table.LARGEST_FILE", 3)
    assert refused(tmp_path / "s.csv")[1] == "s.csv is larger than 0 MB | cut out what is used"


def test_a_parquet_file_has_units_with_its_fields_and_times_of_any_kind(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    stamps = np.array(["2026-03-01T10:00:00", "2026-03-01T10:00:00.5", "2026-03-01T10:00:02"], dtype="datetime64[us]")
    fields = [
        pa.field("stamp", pa.timestamp("us")),
        pa.field("t", pa.float64(), metadata={"unit": "ms"}),
        pa.field("v", pa.int32(), metadata={"unit": "km/h"}),
        pa.field("mode", pa.dictionary(pa.int8(), pa.string())),
        pa.field("gap", pa.float64()),
    ]
    modes = pa.array(["eco", "sport", "eco"]).dictionary_encode().cast(fields[3].type)
    columns = [pa.array(stamps), pa.array([0.0, 500, 2000]), pa.array([0, 18, -36], pa.int32()), modes]
    file = tmp_path / "s.parquet"
    pq.write_table(pa.table([*columns, pa.array([1.0, None, 2.0])], pa.schema(fields)), file)
    for time in ("", "t", "stamp", 1):
        samples = read(file, time=time)
        assert samples.times.tolist() == [0, 0.5, 2]
        assert samples.values.tolist() == [0, 5, -10]
    assert read(file, "mode", type_=Type(Kind.ENUMERATION, items=("eco", "sport"))).values.tolist() == [0, 1, 0]
    _, message = refused(file, "gap [m/s]")
    assert "no value of 'gap' in this row" in message
    assert read(file, "gap [m/s]", missing=Missing.SKIP).times.tolist() == [0, 2]
    file.write_bytes(b"PAR1")
    assert "cannot be read" in refused(file)[1]


def test_an_mdf_file_without_asammdf_is_refused_with_the_line_that_installs_it(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "asammdf", None)
    (tmp_path / "s.mf4").write_bytes(b"MDF     ")
    assert refused(tmp_path / "s.mf4")[1].endswith("python -m pip install 'dse-workbench[mdf]'")


def test_a_channel_of_mdf_has_its_times_and_its_unit(tmp_path):
    asammdf = pytest.importorskip("asammdf")
    times = np.array([0, 0.5, 2])
    file = tmp_path / "s.mf4"

    def signal(name, samples, **more):
        return asammdf.Signal(samples=samples, timestamps=times, name=name, **more)

    with asammdf.MDF(version="4.10") as mdf:
        linear = asammdf.blocks.conversion_utils.from_dict({"a": 2.0, "b": 1.0})
        formula = asammdf.blocks.conversion_utils.from_dict({"formula": "X1*2"})
        mdf.append([
            signal("v", np.array([0, 18, -36], dtype=np.int16), unit="km/h"),
            signal("raw", np.array([0, 1, 2], dtype=np.uint8), unit="m/s", conversion=linear),
            signal("formula", np.array([0, 1, 2], dtype=np.uint8), unit="m/s", conversion=formula),
        ])  # fmt: skip
        mdf.append([signal("v2", np.array([1.0, 2, 3]), unit="m/s")])
        mdf.append([signal("v2", np.array([3.0, 2, 1]), unit="m/s")])
        mdf.save(file)
    samples = read(file)
    assert samples.times.tolist() == times.tolist()
    assert samples.values.tolist() == [0, 5, -10]
    assert read(file, "raw").values.tolist() == [1, 3, 5]
    assert read(file, "v2", group=2).values.tolist() == [3, 2, 1]
    for arguments, said in [
        ({"column": "v2"}, "several channels are called 'v2', in the groups 1, 2 | set 'group"),
        ({"column": "v2", "group": 0}, "the group 0 has no channel 'v2'"),
        ({"column": "formula"}, "converted by a formula in the file, which is not evaluated"),
        ({"column": "w"}, "there is no channel 'w'"),
        ({"time": "t"}, "channels of MDF have their own times"),
        ({"column": 1}, "channels of MDF go by their names"),
    ]:
        assert said in refused(file, **arguments)[1]
    file.write_bytes(b"no measurement")
    assert "cannot be read" in refused(file)[1]
