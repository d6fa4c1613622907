"""``inputs`` of a bench are a part of it like any other: checked, explored, fused, exported, stored by content."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import run_dse
from series.workspace import LEAD, lay_out

import dse
from dse.loading.workspace import Workspace
from dse.testbench.check import check_workspace

LEAD_V = "file: lead.csv, column: v"
GIVEN = "parameters: {part.gear: 0"


def problems(root: Path) -> list[str]:
    found, _ = check_workspace(Workspace(root))
    return [f"{Path(p.where.file).name}:{p.where.line}: {p.what} | {p.hint}" if p.where else p.what for p in found]


@pytest.mark.parametrize(
    ("entry", "change", "said"),
    [
        (LEAD_V, None, None),
        ("file: gone.csv, column: v", None, "fed.yaml:4: no such file"),
        ("file: lead.xlsx, column: v", None, "fed.yaml:4: 'lead.xlsx' must be a .csv or .txt"),
        ("file: ../../lead.csv, column: v", None, "fed.yaml:4: '../../lead.csv' is outside the workspace"),
        ("file: lead.csv", None, "fed.yaml:4: 'column' is missing in 'inputs.part.u'"),
        ("file: lead.csv, column: w", None, "fed.yaml:4: there is no column 'w' | possible: time [s], v [km/h]"),
        ("file: lead.csv, column: 0", None, "fed.yaml:4: columns are counted from 1"),
        (f"{LEAD_V}, colum: 1", None, "fed.yaml:4: unknown key 'colum' | did you mean 'column'?"),
        (
            f"{LEAD_V}, interpolation: cubic",
            None,
            "unknown interpolation 'cubic' | possible: linear, pr",
        ),
        (f"{LEAD_V}, outside: stop", None, "unknown outside 'stop' | possible: error, hold, periodic"),
        (f"{LEAD_V}, missing: drop", None, "unknown missing 'drop' | possible: error, skip"),
        (f"{LEAD_V}, separator: x", None, "'separator' cannot be 'x' | possible: ','"),
        (f"{LEAD_V}, skip_lines: -1", None, "'skip_lines' must be 0 or more"),
        (f"{LEAD_V}, offset: 3 m", None, "wrong unit in '3 m': expected time, found length"),
        (f"{LEAD_V}, offset: 30 s", None, "from 0 s to 2 s, the run from 30 s on never meets it"),
        (
            LEAD_V,
            ("  part.u", "  prt.u"),
            "fed.yaml:4: 'prt.u' names no part | did you mean 'part'",
        ),
        (
            LEAD_V,
            ("  part.u", "  part.v"),
            "fed.yaml:4: 'part' has no input 'v' | possible: gear,",
        ),
        (LEAD_V, ("  part.u", "  part.y"), "fed.yaml:4: 'part.y' is an output"),
        (
            f"{LEAD_V}, gain: 2",
            ("  part.u", "  part.gear"),
            "part.gear' is int, which cannot be multipl",
        ),
        (
            LEAD_V,
            (GIVEN, f"{GIVEN}, part.u: 3"),
            "part.u is given a value and connected to inputs.pa",
        ),
        (
            LEAD_V,
            ("inputs:\n", "connections: [part.y -> part.u]\ninputs:\n"),
            "part.u has a source already",
        ),
        (
            LEAD_V,
            ("inputs:\n", "test_components: {inputs: {component: part}}\ninputs:\n"),
            "a part is called 'inputs', as what feeds inputs is | rename the part",
        ),
    ],
)
def test_what_is_wrong_with_an_input_is_told_once_and_where_it_stands(tmp_path, entry, change, said):
    root = lay_out(tmp_path, entry)
    bench = root / "testbenches/fed.yaml"
    if change:
        text = bench.read_text(encoding="utf-8")
        assert change[0] in text
        bench.write_text(text.replace(*change), encoding="utf-8")
    found = problems(root)
    if said is None:
        assert not found
    else:
        assert len(found) == 1
        assert said in found[0]


def test_an_input_that_differs_between_architectures_is_refused(tmp_path):
    root = lay_out(tmp_path)
    interfaces = root / "components/interfaces.yaml"
    interfaces.write_text(interfaces.read_text(encoding="utf-8") + "  other: {inputs: {u: m}}\n", encoding="utf-8")
    (root / "components/other.yaml").write_text("components: {other: {implements: other}}\n", encoding="utf-8")
    architectures = "{alternatives: [{one: {compound: {m: part}}}, {two: {compound: {m: other}}}]}"
    (root / "designs/fed.yaml").write_text(f"design: fed\nroot: {{compound: {{part: {architectures}}}}}\n", "utf-8")
    bench = root / "testbenches/fed.yaml"
    bench.write_text(bench.read_text(encoding="utf-8").replace("part.", "part.m."), encoding="utf-8")
    assert any("'part.m.u' is not the same in all alternatives: units differ: m/s and m" in p for p in problems(root))


STUDY = """\
study: shifts
testbench: fed
design_variables:
  inputs.part.u.offset: {range: [-1 s, 1 s], levels: 3}
keep_waveforms: all
"""
EXPECTED = np.array([0, 0.35, 1, 2]), np.array([0, 3.5, 2.5, 10])


def explored(root: Path) -> dse.Results:
    return dse.open(root).studies["shifts"].explore(root / "out")


@pytest.mark.thorough
def test_a_study_varies_the_offset_and_a_changed_file_makes_its_runs_anew(tmp_path, monkeypatch):
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    root = lay_out(tmp_path / "ws")
    monkeypatch.chdir(root)
    (root / "testbenches/shifts.pet.yaml").write_text(STUDY, encoding="utf-8")
    t = np.arange(21) * 0.1
    results = explored(root)
    for number, offset in enumerate((-1, 0, 1)):
        got = results.run(number).waveforms["inputs.part.u"]
        assert np.allclose(got, np.interp(t + offset, *EXPECTED), rtol=1e-14, atol=1e-15)
    assert results.replay(1).is_same
    before = results.to_pandas()
    study = dse.open(root).studies["shifts"]
    assert study.plan(root / "out").missing == 0
    (root / "testbenches/lead.csv").write_text(LEAD.replace("36", "72"), encoding="utf-8")
    assert dse.open(root).studies["shifts"].plan(root / "out").missing == 3
    changed = explored(root).to_pandas()
    assert (changed["distance"] != before["distance"]).any()
    (root / "testbenches/lead.csv").write_text(LEAD, encoding="utf-8")
    assert dse.open(root).studies["shifts"].plan(root / "out").missing == 0
    assert explored(root).to_pandas().equals(before)


@pytest.mark.thorough
def test_fused_exported_and_by_the_other_version_of_fmi_it_gives_the_same(tmp_path):
    root = lay_out(tmp_path)
    bench = dse.open(root).benches["fed"]
    plain = bench.simulate().waveforms
    for options in ({"fuse": True}, {"fmi": 3}):
        other = bench.simulate(**options).waveforms
        assert all(np.array_equal(plain[name], other[name]) for name in plain), options
    for arguments in (["export", "ssp", "fed", "-o", "fed.ssp"], ["simulate", "fed.ssp", "-o", "kept.parquet"]):
        done = run_dse(root, *arguments, cache=tmp_path / "cache")
        assert done.returncode == 0, done.stderr
    import pyarrow.parquet as pq

    kept = pq.read_table(root / "kept.parquet")
    assert kept.schema.field("part.seen").metadata == {b"unit": b"m/s"}
    for name in ("part.y", "part.seen"):
        assert np.array_equal(kept.column(name).to_numpy(), plain[name]), name


@pytest.mark.thorough
def test_cycles_as_components_are_alternatives_of_a_design(tmp_path):
    root = lay_out(tmp_path)
    for name, factor in (("slow", 1), ("quick", 2)):
        folder = root / "components" / name
        folder.mkdir()
        (folder / "cycle.csv").write_text(f"t [min],v [m/s]\n0,0\n1,{60 * factor}\n", encoding="utf-8")
        (folder / "component.yaml").write_text(
            f"component: {name}\nimplements: profile\n"
            "source: {kind: time_series, file: cycle.csv, columns: {u: v}, outside: periodic}\n"
            "parameters: {offset: {start: 0 s, min: 0 s, max: 60 s}}\n",
            encoding="utf-8",
        )
    (root / "designs/fed.yaml").write_text(
        "design: fed\nroot: {compound: {cycle: {alternatives: [slow, quick]}, part: part}, "
        "connections: [cycle.u -> part.u]}\n",
        encoding="utf-8",
    )
    bench = root / "testbenches/fed.yaml"
    text = bench.read_text(encoding="utf-8").replace("inputs:\n  part.u: {file: lead.csv, column: v}\n", "")
    bench.write_text(text.replace("inputs.part.u", "cycle.u"), encoding="utf-8")
    assert not problems(root)
    frame = dse.open(root).benches["fed"].run(root / "out").to_pandas()
    assert frame["fed"].tolist() == pytest.approx([2, 4], rel=1e-14)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("columns: {u: v}", "columns: {w: v}"), "'w' is not an output of profile | possible: u"),
        (("columns: {u: v}", "columns: {}"), "'columns' is missing in 'source' | columns: {speed: v [km/h]}"),
        (("parameters: {offset: {start: 0 s}}", "parameters: {delay: {start: 0 s}}"), "no parameter 'delay'"),
        (("{start: 0 s}", "{start: 0 m}"), "'offset' must be time, not m"),
        (("profile", "fed"), "a time series has no inputs, and fed has 'u'"),
        (("outside: hold", "outside: error, interpolation: previous"), None),
    ],
)
def test_what_is_wrong_with_a_component_of_a_series_is_told_by_dse_check(tmp_path, change, said):
    root = lay_out(tmp_path)
    text = (
        "component: cycle\nimplements: profile\n"
        "source: {kind: time_series, file: ../../testbenches/lead.csv, columns: {u: v}, outside: hold}\n"
        "parameters: {offset: {start: 0 s}}\n"
    )
    assert change[0] in text
    (root / "components/cycle").mkdir()
    (root / "components/cycle/component.yaml").write_text(text.replace(*change), encoding="utf-8")
    found = problems(root)
    assert (not found) if said is None else any(said in problem for problem in found), found


@pytest.mark.thorough
def test_a_run_that_leaves_a_series_where_that_is_an_error_fails_by_name(tmp_path):
    root = lay_out(tmp_path, "file: lead.csv, column: v, outside: error")
    bench = dse.open(root).benches["fed"]
    assert bench.simulate().is_done
    run = bench.simulate(set={"inputs.part.u.offset": "0.5 s"})
    assert not run.is_done
    assert "inputs" in run.problem
    assert "part.u" in run.problem
    assert "1.6 s" in run.problem


@pytest.mark.thorough
def test_a_part_called_as_a_word_of_c_is_fed_too(tmp_path):
    root = lay_out(tmp_path)
    for file in ("designs/fed.yaml", "testbenches/fed.yaml"):
        text = (root / file).read_text(encoding="utf-8").replace("{part: part}", "{switch: part}")
        (root / file).write_text(text.replace("part.", "switch."), encoding="utf-8")
    run = dse.open(root).benches["fed"].simulate()
    assert run.waveforms["inputs.switch.u"][-1] == 10


@pytest.mark.thorough
def test_the_waveforms_of_a_bench_are_written_and_feed_another(tmp_path):
    root = lay_out(tmp_path)
    (root / "testbenches/again.yaml").write_text(
        (root / "testbenches/fed.yaml").read_text(encoding="utf-8").replace("testbench: fed", "testbench: again")
        .replace("file: lead.csv, column: v", "file: wave.csv, column: inputs.part.u"), encoding="utf-8")  # fmt: skip
    expected = dse.open(root).benches["fed"].simulate().waveforms
    for suffix in ("csv", "parquet", "json"):
        done = run_dse(root, "simulate", "fed", "-o", f"testbenches/wave.{suffix}", cache=tmp_path / "cache")
        assert done.returncode == 0, done.stderr
        assert f"wave.{suffix}: 3 waveforms of 21 points" in done.stderr
    told = json.loads((root / "testbenches/wave.json").read_text(encoding="utf-8"))
    assert told["bench"] == "fed"
    assert told["signals"]["part.y"] == {"unit": "m", "values": expected["part.y"].tolist()}
    head = (root / "testbenches/wave.csv").read_text(encoding="utf-8").partition("\n")[0]
    assert head == "time,inputs.part.u [m/s],part.y [m],part.seen [m/s]"
    for suffix in ("csv", "parquet"):
        bench = root / "testbenches/again.yaml"
        bench.write_text(bench.read_text(encoding="utf-8").replace("wave.csv", f"wave.{suffix}"), encoding="utf-8")
        again = dse.open(root).benches["again"].simulate().waveforms
        assert all(np.array_equal(again[name], expected[name]) for name in expected), suffix
