"""What ``dse import simulink`` makes of a folder of generated code."""

from __future__ import annotations

from pathlib import Path

import coded_texts as texts
import pytest
from command_line import run_dse
from workspaces import written

from dse.errors import DseError
from dse.interchange import import_code
from dse.kinds import SimulinkSource
from dse.loading import Workspace

pytest.importorskip("clang.cindex")


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


def test_a_component_has_the_ports_and_begins_with_the_values_of_the_code(tmp_path: Path, cache: Path) -> None:
    code = written(tmp_path / "lag_ert_rtw", texts.whole_program())
    made = import_code(code, tmp_path, step=texts.STEP, cache=cache)
    assert made.path == tmp_path / "components" / "lag" / "component.yaml"
    assert made.has_own_interface
    component = Workspace(tmp_path).component("lag")
    assert [(port.name, str(port.type)) for port in component.interface.ports] == [
        ("speed", "1"), ("enable", "bool"), ("filtered", "1"), ("count", "int"),
    ]  # fmt: skip
    (gain,) = component.parameters
    assert (gain.name, gain.start, gain.tunable) == ("Gain", texts.GAIN, True)
    text = made.path.read_text(encoding="utf-8")
    assert 'folder: "../../lag_ert_rtw"' in text
    assert "#   in_code: {speed: {unit: m/s, min: 0, max: 100}}" in text
    with pytest.raises(DseError, match="already exists"):
        import_code(code, tmp_path, step=texts.STEP, cache=cache)


def test_an_interface_of_the_workspace_is_found_by_names_whatever_its_units(tmp_path: Path, cache: Path) -> None:
    known = "interfaces:\n  filter: {inputs: {SPEED: m/s, enable: bool}, outputs: {filtered: N, count: int}}\n"
    (tmp_path / "components").mkdir()
    (tmp_path / "components" / "interfaces.yaml").write_text(known, encoding="utf-8")
    code = written(tmp_path / "lag_ert_rtw", texts.whole_program())
    made = import_code(code, tmp_path, "mine", step=texts.STEP, cache=cache)
    assert not made.has_own_interface
    component = Workspace(tmp_path).component("mine")
    assert (component.interface.name, component.names) == ("filter", {"SPEED": "speed"})


def test_no_output_is_left_out_for_an_interface_that_has_the_same_names_by_chance(tmp_path: Path, cache: Path) -> None:
    known = "interfaces:\n  other: {inputs: {speed: m, enable: bool}, outputs: {filtered: m}}\n"
    (tmp_path / "components").mkdir()
    (tmp_path / "components" / "interfaces.yaml").write_text(known, encoding="utf-8")
    code = written(tmp_path / "lag_ert_rtw", texts.whole_program())
    made = import_code(code, tmp_path, step=texts.STEP, cache=cache)
    assert made.has_own_interface
    assert [port.name for port in made.component.interface.ports] == ["speed", "enable", "filtered", "count"]


def test_items_are_named_and_numbers_that_are_infinite_stay_in_the_code(tmp_path: Path, cache: Path) -> None:
    files = dict(texts.whole_program())
    header, source = files["lag.h"], files["lag.c"]
    files["lag.h"] = header.replace("{ real_T Gain;", "{ real_T Limit; /* Variable: Limit */ real_T Gain;")
    files["lag_data.c"] = files["lag_data.c"].replace("{ 3.0 }", "{ 0.0, 3.0 }")
    files["lag.c"] = source.replace("  lag_U.speed = 0.0;", "  lag_U.speed = 0.0;\n  lag_P.Limit = 1.0e300 * 1.0e300;")
    made = import_code(written(tmp_path / "code", files), tmp_path, step=texts.STEP, cache=cache)
    assert made.left_out == ("Limit: it begins as inf, and keeps that",)
    assert [parameter.name for parameter in made.component.parameters] == ["Gain"]
    machine = written(tmp_path / "machine", texts.whole_numbers())
    whole = import_code(machine, tmp_path, "machine", step=texts.STEP, cache=cache).component
    assert [str(port.type) for port in whole.interface.ports][:3] == ["int", "enum[Off, Slow, Quick]", "int"]


def test_code_that_does_not_come_back_or_says_an_error_is_no_component(
    tmp_path: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = dict(texts.whole_program())
    for name, line, what in (
        ("dies", "__builtin_trap();", r"'lag' crashed \(SIG"),
        ("says", 'lag_M->errorStatus = "no";', "the model reports 'no'"),
    ):
        broken = {**files, "lag.c": files["lag.c"].replace("  lag_Y.count++;", f"  lag_Y.count++;\n  {line}")}
        with pytest.raises(DseError, match=what):
            import_code(written(tmp_path / name, broken), tmp_path, step=texts.STEP, cache=cache)
    assert not (tmp_path / "components").exists()


@pytest.mark.thorough
def test_each_function_of_a_rate_is_imported_with_its_step(tmp_path: Path, cache: Path) -> None:
    code = written(tmp_path / "lag_ert_rtw", texts.uncommented_rates())
    doubled = ("--step", "lag_step0=1ms", "--step", "lag_step0=2ms")
    twice = run_dse(tmp_path, "import", "simulink", code.name, *doubled, cache=cache)
    assert (twice.returncode, "a step is given twice" in twice.stderr) == (2, True)
    steps = ("--step", "lag_step0=20ms", "--step", "lag_step1=0.05")
    done = run_dse(tmp_path, "import", "simulink", code.name, *steps, cache=cache)
    assert done.returncode == 0, done.stderr
    assert "every 0.01 s by 'steps'" in done.stdout
    source = Workspace(tmp_path).component("lag").source
    assert isinstance(source, SimulinkSource)
    assert source.steps == (("lag_step0", 0.02), ("lag_step1", 0.05))
    yaml = tmp_path / "components" / "lag" / "component.yaml"
    yaml.write_text(yaml.read_text("utf-8").replace("lag_step1: 0.05 s", "lag_step1: -1 s"), "utf-8")
    with pytest.raises(DseError, match=r"component\.yaml:\d+:\d+: the step of 'lag_step1' must be positive"):
        Workspace(tmp_path).component("lag")
