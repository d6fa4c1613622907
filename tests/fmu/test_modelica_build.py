"""Modelica components as FMUs: ports and parameters fit, the description is right, nothing is compiled twice."""

from __future__ import annotations

import os
import stat
import sys
import warnings
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dse.domain.component import (
    Causality,
    Component,
    Interface,
    Kind,
    ModelicaCompiler,
    ModelicaSource,
    Parameter,
    Port,
    Solver,
    Type,
)
from dse.errors import DseError, Location
from dse.fmu.component_build import build, build_all
from dse.fmu.toolchain import compilation
from dse.fmu.unpack import open_fmu
from dse.modelica.build import check_modelica
from dse.units import parse_unit

MODEL = """package Lib
  type Mode = enumeration(slow, fast);
  model Lag "A lag with steps"
    parameter Real T(unit = "s", min = 0) = 0.5 "Time constant";
    parameter Real gain(unit = "N.m/rad") = 2;
    parameter Integer stages = 2;
    parameter Mode mode = Mode.fast;
    parameter Boolean is_on = true;
    final parameter Real double = 2*gain;
    parameter Real half = gain/2;
    input Real u(unit = "rad", start = 0) "Angle";
    output Real y(unit = "N.m", max = 1e6);
    output Boolean is_high;
    output Integer level;
    Real x[stages](each start = 0, each fixed = true, each nominal = 10);
    Real z;
    Real w;
    Real celsius(unit = "degC") = 20;
  protected
    parameter Real hidden = 1;
  equation
    der(x[1]) = (gain*u - x[1])/T;
    for i in 2:stages loop
      der(x[i]) = (x[i - 1] - x[i])/T;
    end for;
    y = hidden*x[stages];
    if is_on then
      z = u;
      w = z;
    else
      w = 1;
      z = 2*w;
    end if;
    is_high = y > 1;
    level = if is_high then 2 else 1;
  end Lag;
end Lib;
"""


def real(unit: str = "") -> Type:
    return Type(Kind.REAL, parse_unit(unit))


INTERFACE = Interface(
    "lag",
    (
        Port("angle", Causality.INPUT, real("rad")),
        Port("torque", Causality.OUTPUT, real("N.m")),
        Port("is_high", Causality.OUTPUT, Type(Kind.BOOLEAN)),
        Port("level", Causality.OUTPUT, Type(Kind.INTEGER)),
    ),
)
NAMES = {"angle": "u", "torque": "y"}
TIME_CONSTANT = Parameter("T", real("s"), 0.5, 0.01, 10.0, title="of each stage")


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def lag(tmp_path: Path) -> Component:
    file = tmp_path / "Lib.mo"
    file.write_text(MODEL, encoding="utf-8")
    source = ModelicaSource("Lib.Lag", (file,))
    where = Location("component.yaml", 1, 1)
    return Component("lag", INTERFACE, "", source, (TIME_CONSTANT,), {}, NAMES, where)


def described(archive: Path) -> ET.Element:
    with zipfile.ZipFile(archive) as content:
        return ET.fromstring(content.read("modelDescription.xml"))  # noqa: S314  # our own file


def variables(archive: Path) -> dict[str, dict[str, str]]:
    found = described(archive).find("ModelVariables")
    assert found is not None
    return {v.attrib["name"]: {**v.attrib, **(v[0].attrib if len(v) else {}), "tag": v.tag} for v in found}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_the_fmu_is_valid_and_gives_the_step_response(
    lag: Component, cache: Path, version: int, interface: str
) -> None:
    import fmpy
    from fmpy.validation import validate_fmu

    archive = build(lag, version=version, cache=cache)
    assert validate_fmu(str(archive)) == []
    inputs = np.array([(0.0, 0.5), (2.0, 0.5)], dtype=[("time", "f8"), ("u", "f8")])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        options: dict[str, Any] = {"step_size": 0.01, "output_interval": 0.1, "relative_tolerance": 1e-8}
        result = fmpy.simulate_fmu(str(archive), stop_time=2.0, fmi_type=interface, input=inputs, **options)
    time = result["time"] / 0.5
    expected = 2 * 0.5 * (1 - np.exp(-time) * (1 + time))
    assert result["y"] == pytest.approx(expected, abs=2e-6)


def test_the_description_says_what_the_model_says(lag: Component, cache: Path) -> None:
    found = variables(build(lag, cache=cache))
    assert found["u"].items() >= {"causality": "input", "unit": "rad", "start": "0.0", "description": "Angle"}.items()
    assert found["y"].items() >= {"causality": "output", "unit": "N.m", "max": "1000000.0"}.items()
    assert found["is_high"].items() >= {"causality": "output", "variability": "discrete"}.items()
    own = {"causality": "parameter", "variability": "tunable", "min": "0.01", "max": "10.0", "start": "0.5"}
    assert found["T"].items() >= {**own, "description": "of each stage"}.items()
    assert found["gain"].items() >= {"causality": "parameter", "variability": "tunable", "start": "2.0"}.items()
    assert found["stages"].items() >= {"variability": "constant", "start": "2"}.items()
    assert found["mode"].items() >= {"causality": "parameter", "start": "2"}.items()
    assert found["half"]["causality"] == "calculatedParameter"
    assert found["hidden"]["causality"] == "local"
    assert found["x[1]"].items() >= {"causality": "local", "nominal": "10.0"}.items()
    places = list(found)
    assert places[int(found["der(x[1])"]["derivative"]) - 1] == "x[1]"


def test_units_and_items_are_defined_in_si(lag: Component, cache: Path) -> None:
    root = described(build(lag, cache=cache))
    units = {unit.attrib["name"]: unit[0].attrib for unit in root.iter("Unit") if len(unit)}
    assert units["N.m"] == {"kg": "1", "m": "2", "s": "-2"}
    assert units["rad"] == {"rad": "1"}
    assert units["degC"] == {"K": "1", "offset": "273.15"}
    assert [(item.attrib["name"], item.attrib["value"]) for item in root.iter("Item")] == [("slow", "1"), ("fast", "2")]


def test_the_structure_lists_unknowns_and_what_they_depend_on(lag: Component, cache: Path) -> None:
    root = described(build(lag, version=3, cache=cache))
    names = {v.attrib["valueReference"]: v.attrib["name"] for v in root.find("ModelVariables") or ()}
    structure = root.find("ModelStructure")
    assert structure is not None
    found = {
        (element.tag, names[element.attrib["valueReference"]]): {
            names[number] for number in element.attrib.get("dependencies", "").split()
        }
        for element in structure
    }
    assert found[("Output", "y")] <= {"x[1]", "x[2]"}
    assert found[("ContinuousStateDerivative", "der(x[1])")] == {"u", "x[1]"}
    assert ("InitialUnknown", "x[1]") in found
    assert [name for tag, name in found if tag == "EventIndicator"] == ["eventIndicator[1]"]


@pytest.mark.thorough
@pytest.mark.usefixtures("real_compiler")
def test_the_same_component_is_the_same_bytes_wherever_it_lies(lag: Component, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    file = elsewhere / "Lib.mo"
    file.write_text(MODEL, encoding="utf-8")
    moved = replace(lag, source=ModelicaSource("Lib.Lag", (file,)), where=Location("other.yaml", 9, 9))
    first = build(lag, cache=tmp_path / "a")
    second = build(moved, cache=tmp_path / "b")
    assert first.name == second.name
    assert first.read_bytes() == second.read_bytes()


def test_new_start_values_compile_nothing_of_the_model(
    lag: Component, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = build(lag, cache=cache)
    units: list[str] = []
    compile_object = compilation.compile_object

    def watched(compiler: Any, files: Any, unit: str, extra: Any = ()) -> bytes:
        units.append(unit)
        return compile_object(compiler, files, unit, extra)

    monkeypatch.setattr("dse.modelica.build.compile_object", watched)
    other = build(replace(lag, parameters=(replace(TIME_CONSTANT, start=0.75),)), cache=cache)
    assert units == ["start.c"]
    assert variables(other)["T"]["start"] == "0.75"
    assert variables(first)["T"]["start"] == "0.5"


def test_a_structural_parameter_is_built_in(lag: Component, cache: Path) -> None:
    stages = Parameter("stages", Type(Kind.INTEGER), 4, tunable=False)
    archive = build(replace(lag, parameters=(TIME_CONSTANT, stages)), cache=cache)
    found = variables(archive)
    assert "x[4]" in found
    assert found["stages"]["start"] == "4"
    assert open_fmu(archive, cache=cache).variables["stages"].causality == "local"


def parameter(name: str, type_: Type, start: float | bool | str = 1.0, *, tunable: bool = True) -> Parameter:
    return Parameter(name, type_, start, tunable=tunable, where=Location("component.yaml", 7, 3))


SPEED = Type(Kind.ENUMERATION, items=("slow", "fast"))
MISFITS: list[tuple[dict[str, Any], tuple[str, ...]]] = [
    ({"names": {"angle": "v", "torque": "y"}}, ("component.yaml:1:1: ", "no variable 'v' for input 'angle'", ": u")),
    ({"names": {"angle": "y", "torque": "y"}}, ("'y' of Lib.Lag is not an input, as input 'angle' needs",)),
    ({"names": {"angle": "u", "torque": "x[2]"}}, ("'x[2]' of Lib.Lag is not an output",)),
    ({"names": {"angle": "u", "torque": "level"}}, ("'level' of Lib.Lag is Integer, but output 'torque' is real",)),
    ({"parameters": (parameter("tau", real("s")),)}, ("component.yaml:7:3: ", "no variable 'tau' for parameter 'tau'")),
    ({"parameters": (parameter("double", real()),)}, ("'double' of Lib.Lag is final",)),
    ({"parameters": (parameter("half", real()),)}, ("'half' of Lib.Lag is computed from other parameters",)),
    ({"parameters": (parameter("hidden", real()),)}, ("'hidden' of Lib.Lag is protected",)),
    ({"parameters": (parameter("celsius", real()),)}, ("'celsius' of Lib.Lag is not a parameter",)),
    ({"parameters": (parameter("gain", real("N")),)}, ("'gain' of Lib.Lag is in N.m/rad", "Lib.mo:5:")),
    ({"parameters": (parameter("stages", real()),)}, ("set tunable: false",)),
    ({"parameters": (parameter("stages", real(), tunable=False),)}, ("'stages' of Lib.Lag is Integer", "type: int")),
    ({"parameters": (parameter("is_on", real(), tunable=False),)}, ("'is_on' of Lib.Lag is Boolean", "type: bool")),
    ({"parameters": (Parameter("T", real("s"), 0.5, -1.0),)}, ("'T' goes down to -1, 'T' of Lib.Lag to 0",)),
    (
        {"parameters": (TIME_CONSTANT, parameter("tau", real("s"))), "names": {**NAMES, "tau": "T"}},
        ("parameter 'T' and parameter 'tau' are both the variable 'T'",),
    ),
    ({"parameters": (parameter("mode", SPEED, "fast"),)}, ("parameter 'mode' is an enumeration that the model reads",)),
]  # fmt: skip


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("change", "expected"), MISFITS, ids=[expected[-1][:40] for _, expected in MISFITS])
def test_what_does_not_fit_is_told_with_its_place(
    lag: Component, tmp_path: Path, change: dict[str, Any], expected: tuple[str, ...]
) -> None:
    if "names" not in change and ("tau" in str(change) or "gain" in str(change)):
        change = {**change, "names": NAMES}
    with pytest.raises(DseError) as caught:
        check_modelica(replace(lag, **change), source_of(lag), tmp_path)
    for part in expected:
        assert part in str(caught.value)


def source_of(component: Component) -> ModelicaSource:
    assert isinstance(component.source, ModelicaSource)
    return component.source


def test_an_input_without_a_port_and_a_start_is_told(lag: Component, tmp_path: Path) -> None:
    file = tmp_path / "two.mo"
    file.write_text("model Two input Real u; input Real v; output Real y = u + v; end Two;", encoding="utf-8")
    interface = Interface("one", tuple(Port(n, Causality.INPUT, real()) for n in ("u", "w")))
    source = ModelicaSource("Two", (file,))
    component = replace(lag, interface=interface, source=source, parameters=(), names={})
    with pytest.raises(DseError, match=r"(?s)no variable 'w' for input 'w'.*input 'v' that is not a port"):
        check_modelica(component, source, tmp_path)


def test_what_cannot_be_built_is_told_for_all_components(lag: Component, tmp_path: Path) -> None:
    broken = replace(lag, name="broken", names={"angle": "q", "torque": "y"})
    lost = replace(lag, name="lost", source=ModelicaSource("Lib.Gone", source_of(lag).files))
    with pytest.raises(DseError) as caught:
        build_all([broken, lost], cache=tmp_path)
    assert "component 'broken'" in str(caught.value)
    assert "component 'lost': Lib.Gone" in str(caught.value)


def test_solver_and_tolerance_reach_the_code(lag: Component, cache: Path) -> None:
    asked = replace(lag, source=replace(source_of(lag), solver=Solver.STIFF, tolerance=1e-9))
    archive = build(asked, cache=cache)
    with zipfile.ZipFile(archive) as content:
        text = content.read("sources/runtime/model.h").decode()
    assert "#define DSE_SOLVER DSE_STIFF_SOLVER" in text
    experiment = described(archive).find("DefaultExperiment")
    assert experiment is not None
    assert experiment.attrib["tolerance"] == "1e-09"


DELAYED = "model Late input Real u(start = 0); output Real y = delay(u, 0.5); end Late;"

OMC = """#!{python}
import shutil, sys
if "--version" in sys.argv:
    print("OpenModelica 1.24.0")
    raise SystemExit
script = open(sys.argv[1], encoding="utf-8").read()
assert 'buildModelFMU(DseWrapper, version = "2.0", fmuType = "me_cs"' in script
assert 'loadFile("files/late.mo")' in script
assert "extends Late" in open("wrapper.mo", encoding="utf-8").read()
if {fails}:
    print('"[' + "/tmp/x/files/late.mo" + ':1:7-1:20:writable] Error: Too few equations, under-determined system.\\n"')
else:
    shutil.copyfile({fmu!r}, "dse_product.fmu")
"""


def with_omc(folder: Path, monkeypatch: pytest.MonkeyPatch, fmu: str, *, fails: bool = False) -> None:
    tools = folder / "tools"
    tools.mkdir()
    script = tools / "omc"
    script.write_text(OMC.format(python=sys.executable, fmu=fmu, fails=fails), encoding="utf-8")
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{tools}{os.pathsep}{os.environ['PATH']}")


@pytest.fixture
def late(tmp_path: Path) -> Component:
    file = tmp_path / "late.mo"
    file.write_text(DELAYED, encoding="utf-8")
    interface = Interface("late", (Port("u", Causality.INPUT, real()), Port("y", Causality.OUTPUT, real())))
    return Component("late", interface, "", ModelicaSource("Late", (file,)), where=Location("component.yaml", 1, 1))


def test_what_is_refused_names_omc_as_a_way_out(
    late: Component, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("dse.modelica.build.find_omc", lambda: None)
    with pytest.raises(DseError, match=r"(?s)late\.mo:1:.*if OpenModelica's omc were on PATH, it would be tried"):
        build(late, cache=tmp_path)
    alone = replace(late, source=replace(source_of(late), compiler=ModelicaCompiler.RUMOCA))
    with pytest.raises(DseError) as caught:
        build(alone, cache=tmp_path)
    assert "OpenModelica" not in str(caught.value)
    asked = replace(late, source=replace(source_of(late), compiler=ModelicaCompiler.OMC))
    with pytest.raises(DseError, match="its compiler is omc, which is not on PATH"):
        build(asked, cache=tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in for omc is a script")
def test_omc_builds_what_is_refused_and_what_asks_for_it(
    late: Component, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "plain.mo"
    file.write_text("model Plain input Real u(start = 0); output Real y = u; end Plain;", encoding="utf-8")
    plain = build(replace(late, name="plain", source=ModelicaSource("Plain", (file,))), cache=tmp_path)
    with_omc(tmp_path, monkeypatch, str(plain))
    (note,) = check_modelica(late, source_of(late), tmp_path)
    assert note.what.startswith("component 'late': translated by OpenModelica's omc, because dse refuses the model: ")
    assert "delay" in note.what
    built = build(late, cache=tmp_path)
    assert built.name.startswith("late-")
    assert built.read_bytes() == plain.read_bytes()
    asked = replace(late, name="asked", source=replace(source_of(late), compiler=ModelicaCompiler.OMC))
    assert build(asked, cache=tmp_path).name.startswith("asked-")
    (note,) = check_modelica(asked, source_of(asked), tmp_path)
    assert note.what == "component 'asked': translated by OpenModelica's omc, as asked"
    with pytest.raises(DseError, match=r"omc writes FMI 2\.0, not 3"):
        build(asked, version=3, cache=tmp_path)
    other = replace(asked, interface=Interface("other", (Port("z", Causality.OUTPUT, real()),)))
    with pytest.raises(DseError, match="the model has no variable 'z' for output 'z'"):
        build(other, cache=tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in for omc is a script")
def test_what_omc_says_is_told_in_the_users_file(
    late: Component, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_omc(tmp_path, monkeypatch, "", fails=True)
    with pytest.raises(DseError, match=r"late\.mo:1:7: omc: Too few equations"):
        build(late, cache=tmp_path)


def test_what_was_assumed_stands_in_the_fmu(tmp_path: Path) -> None:
    file = tmp_path / "free.mo"
    file.write_text("model Free Real x(start = 3); output Real y = x; equation der(x) = -x; end Free;", "utf-8")
    interface = Interface("free", (Port("y", Causality.OUTPUT, real()),))
    component = Component("free", interface, "a < b", ModelicaSource("Free", (file,)))
    with zipfile.ZipFile(build(component, cache=tmp_path)) as content:
        page = content.read("documentation/index.html").decode()
    assert "<h1>a &lt; b</h1>" in page
    assert "<li>free.mo" in page
    assert "start of x" in page or "x starts" in page
    assert str(tmp_path) not in page


def test_an_element_of_an_array_that_is_used_up_cannot_be_given(tmp_path: Path) -> None:
    file = tmp_path / "sized.mo"
    declared = "parameter Real T[2] = {0.5, 1}; discrete output Real y(start = 0, fixed = true);"
    file.write_text(
        f"model Sized {declared} equation when sample(0, T[1]) then y = pre(y) + 1; end when; end Sized;", "utf-8"
    )
    interface = Interface("sized", (Port("y", Causality.OUTPUT, real()),))
    given = Parameter("T[1]", real(), 0.25, tunable=False)
    component = Component("sized", interface, "", ModelicaSource("Sized", (file,)), (given,))
    with pytest.raises(DseError, match="element of an array that decides how the model is built"):
        build(component, cache=tmp_path)
