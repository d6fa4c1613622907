"""What can be fused and what is refused by name; libraries are made once, and the same everywhere."""

from __future__ import annotations

import importlib.util
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from fusion.conftest import REAL, TRUTH, WHOLE, Workshop, both_ways, ports, system_of

from dse.cosim.simulator import Simulator
from dse.domain.method import PLAIN, Algorithm, Bond, Method
from dse.domain.system import Conversion, SystemStructure
from dse.errors import DseError
from dse.fmu.fusion.fuse import Wanted, fuse, fuse_all
from dse.fmu.fusion.part import build_part
from dse.fmu.fusion.sources import own_sources
from dse.fmu.fusion.web import WebSystem, web_module
from dse.fmu.toolchain.compiler import find_compiler

CODE = "void {0}_init({0} *c) {{ c->out.y = 1; }}\nvoid {0}_step({0} *c, double h) {{ c->out.y += h * c->in.u; }}"
MEMBERS = "struct { double u; } in; struct { double y; } out;"
PORTS = ports({"u": REAL}, {"y": REAL})
RECORD = ["a.y", "b.y"]


@pytest.fixture
def case() -> tuple[int, Method]:
    """What is told here is the same for both versions of FMI, and either algorithm."""
    return 2, PLAIN


def pair(workshop: Workshop, *names: str) -> SystemStructure:
    one, two = (workshop.c(name, MEMBERS, CODE.format(name), PORTS) for name in names or ("plus", "minus"))
    return system_of({"a": one, "b": two}, ["a.y -> b.u", "b.y -> a.u"], RECORD)


def refused(system: SystemStructure, **wanted: Method) -> list[str]:
    with pytest.raises(DseError) as caught:
        fuse_all({"x": Wanted(system, tuple(RECORD), **wanted)})
    return [problem.what for problem in caught.value.problems]


def test_a_library_is_made_once_for_a_system_and_a_record(workshop, tmp_path):
    system = pair(workshop)
    cache = tmp_path / "cache"
    first = fuse(system, RECORD, cache=cache)
    made = {path: path.stat().st_mtime_ns for path in cache.rglob("*") if path.is_file()}
    started = replace(system, elements=tuple(replace(e, start={"u": 2.0}) for e in system.elements))
    assert fuse(started, RECORD, cache=cache).path == first.path  # start values are not compiled in
    assert {path: path.stat().st_mtime_ns for path in cache.rglob("*") if path.is_file()} == made
    assert fuse(system, RECORD[:1], cache=cache).path != first.path


@pytest.mark.usefixtures("real_compiler")
@pytest.mark.thorough
def test_the_same_system_gives_the_same_bytes_in_another_cache(workshop, tmp_path):
    system = pair(workshop)
    one, two = (fuse(system, RECORD, cache=tmp_path / name).path for name in ("one", "two"))
    assert one.name == two.name
    assert one.read_bytes() == two.read_bytes()


def test_a_component_is_compiled_once_for_several_systems(workshop, tmp_path):
    system = pair(workshop)
    other = system_of({"a": system.elements[0].model}, [], ["a.y"])
    libraries = fuse_all(
        {"pair": Wanted(system, tuple(RECORD)), "single": Wanted(other, ("a.y",))}, cache=tmp_path / "cache"
    )
    assert len({library.path for library in libraries.values()}) == 2
    assert len(list((tmp_path / "cache" / "fused" / "parts").glob("*.digest"))) == 2


def test_all_that_is_no_component_of_ours_is_told_by_name(workshop):
    system = pair(workshop)
    a, b = system.elements
    bare = workshop.folder / "bare"
    shutil.copytree(a.model.folder, bare, ignore=shutil.ignore_patterns("sources"))
    changed = workshop.folder / "changed"
    shutil.copytree(b.model.folder, changed)
    with (changed / "sources" / "runtime" / "value.h").open("a", encoding="utf-8") as file:
        file.write("/* older */\n")
    finished = replace(a, model=replace(a.model, folder=bare, library=bare / "x"))
    older = replace(b, model=replace(b.model, folder=changed, library=changed / "x"))
    found = refused(replace(system, elements=(finished, older)))
    assert found == [
        f"a: the FMU {a.model.archive.name} was not built by dse from C or Modelica, so it cannot be fused",
        f"b: the FMU {b.model.archive.name} was built by another version of dse, so it cannot be fused",
    ]


@pytest.mark.parametrize(
    "method",
    [Method(steps={"a": 0.02}), Method(bonds=(Bond("e", "a.y", "b.y"),))],
    ids=["steps", "bonds"],
)
def test_a_method_other_than_the_plain_ones_is_refused(workshop, method):
    (what,) = refused(pair(workshop), method=method)
    assert what.startswith("tested: a fused loop supports only one fixed step")


def test_conversions_and_arrays_are_refused_by_name(workshop):
    system = pair(workshop)
    a, b = system.elements
    a = replace(a, conversions={"y": Conversion(factor=2.0)})
    b = replace(b, inputs=tuple(replace(v, shape=(1,)) for v in b.inputs))
    wires = tuple(replace(wire, factor=3.0) if wire.source == "b" else wire for wire in system.wires)
    assert refused(SystemStructure("x", (a, b), wires)) == [
        "a.y: a variable with a conversion cannot be fused",
        "b.u: arrays cannot be fused",
        "b.y -> a.u: a connection with a conversion cannot be fused",
    ]


def test_a_conversion_of_a_parameter_does_not_matter(workshop):
    system = pair(workshop)
    elements = tuple(replace(e, conversions={"k": Conversion(factor=2.0)}) for e in system.elements)
    assert workshop.fuse(replace(system, elements=elements), RECORD).path == workshop.fuse(system, RECORD).path


def test_loose_and_unknown_ends_are_told(workshop):
    system = pair(workshop)
    found = refused(replace(system, wires=(*system.wires[:1], replace(system.wires[0], target_variable="y"))))
    assert sorted(found) == ["a.u: 0 wires end at this input", "b.y: a wire ends at what is not an input"]
    with pytest.raises(DseError, match=r"no output 'a\.z'"):
        fuse(system, ["a.z"])


def test_the_time_of_fmi_3_is_no_member(workshop):
    system = pair(replace(workshop, version=3))
    first = system.elements[0]
    time = first.model.variables["time"]
    system = replace(system, elements=(replace(first, outputs=(*first.outputs, time)), *system.elements[1:]))
    assert refused(system) == ["a.time: only ports and parameters can be fused"]


def test_a_library_is_not_used_for_another_system(workshop):
    system = pair(workshop)
    fused = workshop.fuse(system, RECORD)
    swapped = replace(system, elements=system.elements[::-1])
    unwired = replace(system, wires=system.wires[::-1])
    for other, record, what in ((swapped, RECORD, "elements"), (unwired, RECORD, "wires"), (system, ["b.y"], "record")):
        with pytest.raises(DseError, match=f"not fused for this system: this one has other .*{what}"):
            Simulator(other, record, fused=fused)
    with pytest.raises(DseError, match="another method"):
        Simulator(system, RECORD, fused=fused, method=Method(algorithm=Algorithm.GAUSS_SEIDEL))
    with pytest.raises(DseError, match="is gone"):
        Simulator(system, RECORD, fused=replace(fused, path=Path("nowhere.so")))


def test_the_layout_is_that_of_the_compiler(workshop, tmp_path):
    members = "struct { double u; float f; } in; struct { bool b; int16_t n; double y; } out;"
    code = "void odd_init(odd *c) { (void)c; }\nvoid odd_step(odd *c, double h) { c->out.y = h; }"
    model = workshop.c("odd", members, code, ports({"u": REAL, "f": REAL}, {"b": TRUTH, "n": WHOLE, "y": REAL}))
    part = build_part(own_sources(model), find_compiler(), tmp_path)
    places = {place.row.member: place for place in part.layout.places}
    begin = places["in.u"].at
    assert {name: (place.at - begin, place.c_type.accessor) for name, place in places.items()} == {
        "in.u": (0, "f64"),
        "in.f": (8, "f32"),
        "out.b": (16, "bool"),
        "out.n": (18, "i16"),
        "out.y": (24, "f64"),
    }


@pytest.mark.thorough
@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")
def test_another_compiler_builds_the_same_loop(workshop, monkeypatch, tmp_path):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", "")
    assert find_compiler().identity.startswith("ziglang ")
    zig = replace(workshop, cache=tmp_path / "zig")
    both_ways(zig, pair(zig), RECORD, [{}, {}])


def test_what_cannot_be_in_a_page_is_told_by_name(workshop):
    system = pair(workshop)
    coupled = Method(steps={"a": 0.02})
    newer = system_of({"c": replace(system.elements[0].model, version=3)}, [], ["c.y"])
    with pytest.raises(DseError) as caught:
        web_module([WebSystem(system, tuple(RECORD), (), coupled), WebSystem(newer, ("c.y",))])
    assert [problem.what for problem in caught.value.problems] == [
        "a page simulates with inputs held, fixed steps, no coupling, no bonds, and no elements that lead",
        "c: a page has components of FMI 2 only",
    ]
