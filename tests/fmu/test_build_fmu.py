"""What build() makes: valid archives, the same bytes for the same input, from the cache where it can."""

from __future__ import annotations

import stat
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from dse.cache import content_key
from dse.domain.component import (
    Causality,
    Interface,
    Kind,
    Parameter,
    Port,
    Type,
)
from dse.errors import DseError, Location
from dse.fmu.c import build as c_build
from dse.fmu.c.describe import describe
from dse.fmu.component_build import build, build_all
from dse.fmu.toolchain.compiler import environment, find_compiler
from dse.fmu.toolchain.platforms import this_platform
from dse.fmu.unpack import open_fmu
from dse.kinds.fmu import FmuSource
from dse.units import parse_unit

MODE = Type(Kind.ENUMERATION, items=("speed", "distance"))


def real(unit):
    return Type(Kind.REAL, parse_unit(unit))


@pytest.fixture
def controller(workshop):
    """A component with every kind of port, units that are not coherent, and titles that XML has to escape."""
    return workshop.component(
        "controller",
        """
        typedef struct {
            struct { double speed; bool detected; struct { double gap; } target; } in;
            struct { double torque; int mode; } out;
            struct { double gain, limit, price; int levels; bool on; int first; } par;
        } controller;
        void controller_init(controller *c);
        void controller_step(controller *c);
        """,
        """
        void controller_init(controller *c) { c->out.mode = c->par.first; }
        void controller_step(controller *c) { c->out.torque = c->par.gain * c->in.target.gap; }
        """,
        Interface(
            "acc",
            (
                Port("speed", Causality.INPUT, real("km/h")),
                Port("detected", Causality.INPUT, Type(Kind.BOOLEAN)),
                Port("target.gap", Causality.INPUT, real("m")),
                Port("torque", Causality.OUTPUT, real("N.m")),
                Port("mode", Causality.OUTPUT, MODE),
            ),
        ),
        (
            Parameter("gain", real("kN"), 0.5, 0.0, 5.0, title='P gain, "proportional" & <plain>'),
            Parameter("limit", real("degC"), 373.15),
            Parameter("price", real("EUR"), 12.0),
            Parameter("levels", Type(Kind.INTEGER), 3, 0, 9, tunable=False),
            Parameter("on", Type(Kind.BOOLEAN), True),
            Parameter("first", MODE, "distance"),
        ),
        step=0.01,
        title="A controller & its <title>",
    )


@pytest.mark.sampled(2)
def test_the_archive_is_valid_in_the_eyes_of_fmpy(controller, workshop, cache, version):
    from fmpy.validation import validate_fmu

    for component in (controller, workshop.counter(), workshop.integrator()):
        assert validate_fmu(str(build(component, version=version, cache=cache))) == []


def test_fmpy_simulates_it(controller, cache, version):
    from fmpy import simulate_fmu

    archive = build(controller, version=version, cache=cache)
    result = simulate_fmu(
        str(archive), stop_time=0.05, step_size=0.01, output_interval=0.01, start_values={"target.gap": 40.0, "gain": 2}
    )
    assert list(result["torque"]) == [0.0, 80.0, 80.0, 80.0, 80.0, 80.0]
    assert list(result["mode"]) == [1] * 6


def test_the_description_says_units_bounds_and_items(controller, cache, version):
    from fmpy import read_model_description

    described = read_model_description(str(build(controller, version=version, cache=cache)))
    by_name = {variable.name: variable for variable in described.modelVariables}
    assert described.description == "A controller & its <title>"
    assert (by_name["speed"].unit, by_name["torque"].unit) == ("km/h", "N.m")
    # A parameter's numbers are in the coherent unit, whatever unit the author wrote.
    assert [by_name[n].unit for n in ("gain", "limit", "price")] == ["kg.m/s2", "K", "EUR"]
    gain = by_name["gain"]
    assert (gain.start, gain.min, gain.max, gain.variability) == ("0.5", "0.0", "5.0", "tunable")
    assert gain.description == 'P gain, "proportional" & <plain>'
    assert (by_name["levels"].start, by_name["levels"].variability) == ("3", "fixed")
    assert by_name["on"].start == "true"
    assert by_name["first"].start == "1"
    items = by_name["mode"].declaredType.items
    assert [(item.name, int(item.value)) for item in items] == [("speed", 0), ("distance", 1)]
    units = {unit.name: unit.baseUnit for unit in described.unitDefinitions}
    torque, speed = units["N.m"], units["km/h"]
    assert (torque.kg, torque.m, torque.s, torque.factor) == (1, 2, -2, 1.0)
    assert speed.factor == pytest.approx(1 / 3.6, abs=0)
    assert units["EUR"] is None


def test_open_fmu_gives_back_what_the_component_declares(controller, cache, version):
    model = open_fmu(build(controller, version=version, cache=cache), cache=cache)
    variables = model.variables
    assert (model.version, model.identifier, model.capabilities.can_save_state) == (version, "controller", True)
    assert model.capabilities.can_handle_variable_step
    assert not model.capabilities.once_per_process
    assert model.library.is_file()
    shown = [(v.name, v.causality, v.kind, v.unit) for v in variables.values() if v.causality != "independent"]
    assert shown[:5] == [
        ("speed", "input", Kind.REAL, "km/h"),
        ("detected", "input", Kind.BOOLEAN, ""),
        ("target.gap", "input", Kind.REAL, "m"),
        ("torque", "output", Kind.REAL, "N.m"),
        ("mode", "output", Kind.ENUMERATION, ""),
    ]
    assert variables["mode"].fmi_type == ("Integer" if version == 2 else "Int64")
    assert variables["gain"].start == ("0.5",)


@pytest.mark.sampled(2)
@pytest.mark.usefixtures("real_compiler")
def test_the_same_component_elsewhere_is_the_same_bytes(workshop, tmp_path_factory, version):
    archives = []
    for _ in range(2):
        elsewhere = type(workshop)(tmp_path_factory.mktemp("elsewhere"))
        archives.append(build(elsewhere.counter(), version=version, cache=tmp_path_factory.mktemp("empty")))
    assert archives[0] != archives[1]
    assert archives[0].name == archives[1].name
    assert archives[0].read_bytes() == archives[1].read_bytes()


def test_the_token_names_the_contents_which_are_written_once(workshop, tmp_path, version, monkeypatch):
    written = []

    def counted(*arguments):
        written.append(arguments)
        return describe(*arguments)

    monkeypatch.setattr(c_build, "describe", counted)
    archive = build(workshop.counter(), version=version, cache=tmp_path)
    assert len(written) == 1
    with zipfile.ZipFile(archive) as opened:
        contents = {name: opened.read(name) for name in opened.namelist() if not name.startswith("binaries")}
    token = open_fmu(archive, cache=tmp_path).token
    assert token.encode() in contents["sources/runtime/model.h"]
    blank = {name: text.replace(token.encode(), b"") for name, text in contents.items()}
    assert token == "{" + content_key(sorted(blank.items())) + "}"


def test_the_archive_holds_no_path_of_this_machine(workshop, cache, version):
    content = build(workshop.counter(), version=version, cache=cache).read_bytes()
    assert str(workshop.folder).encode() not in content
    assert str(Path(__file__).parents[2]).encode() not in content


def test_the_embedded_sources_build_the_library_again(workshop, cache, version, tmp_path):
    archive = build(workshop.counter(), version=version, cache=cache)
    with zipfile.ZipFile(archive) as opened:
        opened.extractall(tmp_path)
        names = opened.namelist()
    assert "sources/component/counter.c" in names
    assert ("sources/buildDescription.xml" in names) == (version == 3)
    sources = tmp_path / "sources"
    strict = ["-std=c11", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wno-sign-conversion", "-Werror"]
    command = [*find_compiler().command, *strict, "-I.", "-fPIC", "-shared", "-o", str(tmp_path / "again")]
    units = [f"runtime/fmi{version}.c", "component/counter.c"]
    subprocess.run([*command, *units], cwd=sources, check=True, env=environment())


@pytest.mark.parametrize("version", [3])
def test_the_build_description_is_valid(workshop, cache, version):
    import fmpy
    from lxml import etree

    schema = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3BuildDescription.xsd"
    with zipfile.ZipFile(build(workshop.counter(), version=version, cache=cache)) as opened:
        document = etree.fromstring(opened.read("sources/buildDescription.xml"))
    etree.XMLSchema(etree.parse(str(schema))).assertValid(document)


@pytest.fixture
def counting_compiler(tmp_path, monkeypatch):
    """A CC that counts how often it compiles."""
    if sys.platform == "win32":
        pytest.skip("the counting compiler is a shell script")
    log = tmp_path / "log"
    log.touch()
    script = tmp_path / "counting-cc"
    real_command = " ".join(find_compiler().command)
    script.write_text(
        f'#!/bin/sh\ncase "$*" in *-shared*) echo run >> "{log}";; esac\nexec {real_command} "$@"\n', encoding="utf-8"
    )
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("CC", str(script))
    return lambda: len(log.read_text(encoding="utf-8").splitlines())


def test_what_is_built_is_not_built_again_until_something_changes(workshop, counting_compiler, tmp_path, monkeypatch):
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))
    component = workshop.counter()
    first = build(component)
    assert first.is_relative_to(tmp_path / "cache")
    assert build(component) == first
    assert counting_compiler() == 1
    parameters = (replace(component.parameters[0], start=4.0), *component.parameters[1:])
    others = [
        build(replace(component, parameters=parameters)),
        build(component, version=3),
    ]
    header = component.source.header
    header.write_text(header.read_text(encoding="utf-8") + "/* changed */\n", encoding="utf-8")
    others.append(build(component))
    (header.parent / "beside.h").write_text("/* might be included */\n", encoding="utf-8")
    others.append(build(component))
    assert counting_compiler() == 5
    assert len({first, *others}) == 5


def test_build_all_builds_each_and_collects_every_problem(workshop, cache, tmp_path):
    good = [workshop.counter(), workshop.integrator()]
    built = build_all(good, cache=cache)
    assert {name: path.is_file() for name, path in built.items()} == {"counter": True, "integrator": True}
    bad = [replace(good[0], name="soul", source=None), replace(good[0], name="body", source=None)]
    with pytest.raises(DseError) as caught:
        build_all([*good, *bad], cache=cache)
    assert [problem.what for problem in caught.value.problems] == [
        "component 'soul' has no source, so there is nothing to build",
        "component 'body' has no source, so there is nothing to build",
    ]


def test_a_finished_fmu_is_taken_as_it_is_if_it_is_there(workshop, cache, tmp_path):
    archive = build(workshop.counter(), cache=cache)
    supplied = replace(workshop.counter(), source=FmuSource(archive), where=Location("x.yaml", 3, 1))
    assert build(supplied, cache=cache) == archive
    missing = replace(supplied, source=FmuSource(tmp_path / "gone.fmu"))
    with pytest.raises(DseError, match=r"x\.yaml:3:1: component 'counter': there is no FMU .*gone\.fmu"):
        build(missing, cache=cache)


def test_only_fmi_2_and_3_are_built(workshop, cache):
    with pytest.raises(DseError, match="FMUs are built for FMI 2 and 3, not 1"):
        build(workshop.counter(), version=1, cache=cache)


def test_a_cache_that_cannot_be_written_is_named(workshop, tmp_path):
    (tmp_path / "file").write_text("not a folder", encoding="utf-8")
    with pytest.raises(DseError, match=r"the cache folder .*file.* cannot be written"):
        build(workshop.counter(), cache=tmp_path / "file")


def test_a_name_that_is_no_c_identifier_gets_one_for_the_library(workshop, cache):
    component = replace(workshop.counter(), name="2-stage counter")
    model = open_fmu(build(component, cache=cache), cache=cache)
    assert model.identifier == "_2_stage_counter"
    assert model.library.name == f"_2_stage_counter{this_platform().suffix}"
