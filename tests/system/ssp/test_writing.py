"""What is written is valid, opens again as the same system, and is the same bytes when written again."""

from __future__ import annotations

import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy
import pytest
from hypothesis import given, settings, strategies as st
from lxml import etree
from ssp_packages import METRES_PER_SECOND, model, variable

from dse.domain.component import Kind
from dse.domain.fmu import FmuModel
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import DseError
from dse.interchange.reading.open import open_ssp
from dse.interchange.resolving.resolve import system_of
from dse.interchange.structure import ExperimentSettings
from dse.interchange.writing.write import write_ssp

SCHEMAS = Path(fmpy.__file__).parent / "ssp" / "schema"
EXPERIMENT = ExperimentSettings(0.0, 2.0, 0.01, 0.1, 1e-7)
ITEMS = {"off": 0, "on": 3}


def fmu(folder: Path, identifier: str, *variables, version: int = 2, **more) -> FmuModel:
    """A described FMU with an archive to be copied."""
    archive = folder / f"{identifier}.fmu"
    archive.write_bytes(identifier.encode())
    if version == 2:
        words = {Kind.REAL: "Real", Kind.INTEGER: "Integer", Kind.BOOLEAN: "Boolean", Kind.ENUMERATION: "Integer"}
        variables = tuple(replace(v, fmi_type=words[v.kind] if v.kind else v.fmi_type) for v in variables)
    return replace(model(identifier, *variables, **more), archive=archive, version=version)


def plant(folder: Path) -> FmuModel:
    return fmu(
        folder,
        "plant",
        variable("u", "input", unit="km/h"),
        variable("y", "output", unit="m/s"),
        variable("on", "output", Kind.BOOLEAN),
        variable("off", "input", Kind.BOOLEAN),
        variable("n", "output", Kind.INTEGER),
        variable("m", "input", Kind.INTEGER),
        variable("mode", "output", Kind.ENUMERATION, items=ITEMS),
        variable("wanted", "input", Kind.ENUMERATION, items=ITEMS),
        variable("text", "parameter", None, start=("hello",)),
        variable("k", "parameter", start=("1",), unit="km/h"),
        variable("count", "parameter", Kind.INTEGER, start=("2",)),
        variable("flag", "parameter", Kind.BOOLEAN, start=("false",)),
        variable("state", "parameter", Kind.ENUMERATION, items=ITEMS, start=("0",)),
        units=METRES_PER_SECOND,
    )


def element(name: str, fmu: FmuModel, inputs=(), outputs=(), start=None, **more) -> Element:
    pick = fmu.variables.__getitem__
    return Element(name, fmu, tuple(map(pick, inputs)), tuple(map(pick, outputs)), start or {}, **more)


def written(folder: Path, system: SystemStructure, name: str = "written") -> Path:
    target = folder / f"{name}.ssp"
    write_ssp(target, "example", system, EXPERIMENT)
    assert open_ssp(target, folder / "unpacked").experiment == EXPERIMENT
    return target


def read_again(folder: Path, path: Path, *fmus: FmuModel) -> SystemStructure:
    ssp = open_ssp(path, folder / "unpacked")
    by_name = {one.identifier: one for one in fmus}
    return system_of(ssp, {c.key: by_name[c.fmu.stem] for c in ssp.places.values()}).structure


def text_of(path: Path) -> str:
    return zipfile.ZipFile(path).read("SystemStructure.ssd").decode()


def require_valid(path: Path) -> None:
    """Raise unless the description and the parameter sets in it are as the standard's schemas want them."""
    root = etree.fromstring(zipfile.ZipFile(path).read("SystemStructure.ssd"))
    etree.XMLSchema(file=str(SCHEMAS / "SystemStructureDescription.xsd")).assertValid(root)
    values = etree.XMLSchema(file=str(SCHEMAS / "SystemStructureParameterValues.xsd"))
    for found in root.iter("{http://ssp-standard.org/SSP1/SystemStructureParameterValues}ParameterSet"):
        values.assertValid(etree.fromstring(etree.tostring(found)))


def full_system(folder: Path) -> tuple[SystemStructure, FmuModel]:
    one = plant(folder)
    kinds = (("y", "u"), ("on", "off"), ("n", "m"), ("mode", "wanted"))
    start = {"k": 3.0, "count": 2.0, "flag": 1.0, "state": 3.0, "u": 0.5}
    a = element("a.first", one, ["off", "m", "wanted"], ["y", "on", "n", "mode"], start, texts={"text": "<&>"})
    b = element("b", one, ["u", "off", "m", "wanted"], ["on", "n", "mode"], {"k": 1.0})
    wires = [Wire("a.first", out, "b", into) for out, into in kinds]
    wires = [replace(w, factor=3.6) if w.source_variable == "y" else w for w in wires]
    wires += [
        Wire("b", "on", "a.first", "off", items=((0.0, 1.0), (1.0, 0.0))),
        Wire("b", "n", "a.first", "m", items=((4.0, 7.0),)),
        Wire("b", "mode", "a.first", "wanted", items=((0.0, 3.0), (3.0, 0.0))),
    ]
    return SystemStructure("s", (a, b), tuple(wires)), one


def test_what_is_written_is_valid(tmp_path):
    system, _ = full_system(tmp_path)
    require_valid(written(tmp_path, system))


def test_the_start_values_of_all_components_are_sets_of_one_name(tmp_path):
    # Some programs take the name of the sets to apply, and only one.
    one = plant(tmp_path)
    parts = tuple(element(name, one, start={"k": value}) for name, value in (("a", 3.0), ("b", 4.0)))
    root = etree.fromstring(text_of(written(tmp_path, SystemStructure("s", parts, ()))).encode())
    names = [found.get("name") for found in root.iter("{*}ParameterSet")]
    assert len(names) == 2
    assert len(set(names)) == 1


def test_enumerations_start_with_the_names_of_their_items_arrays_too(tmp_path):
    one = fmu(
        tmp_path,
        "modes",
        variable("state", "parameter", Kind.ENUMERATION, items=ITEMS, start=("0",)),
        variable("each", "parameter", Kind.ENUMERATION, items=ITEMS, shape=(2,), start=("0",)),
        variable("odd", "parameter", Kind.ENUMERATION, items=ITEMS, start=("0",)),
        version=3,
    )
    start = {"state": 3.0, "each[1]": 3.0, "each[2]": 0.0, "odd": 7.0}
    path = written(tmp_path, SystemStructure("s", (element("a", one, start=start),), ()))
    root = etree.fromstring(text_of(path).encode())
    found = {each.get("name"): each for each in root.iter("{*}Parameter")}
    tags = {name: etree.QName(each[0]).localname for name, each in found.items()}
    assert tags == {"state": "Enumeration", "each": "Enumeration", "odd": "Int64"}
    assert found["state"][0].get("value") == "on"
    assert found["state"][0].get("name") == found["each"][0].get("name")
    (definition,) = root.find(".//{*}ParameterSet/{*}Enumerations")
    assert definition.get("name") == found["state"][0].get("name")
    assert {item.get("name"): int(item.get("value")) for item in definition} == ITEMS
    assert [value.get("value") for value in found["each"][0]] == ["on", "off"]
    assert read_again(tmp_path, path, one).element("a").start == start


def test_what_is_written_is_read_as_the_same_system(tmp_path):
    system, one = full_system(tmp_path)
    again = read_again(tmp_path, written(tmp_path, system), one)
    first, second = again.element("a_first"), again.element("b")
    assert [v.name for v in first.inputs] == ["off", "m", "wanted"]
    assert [v.name for v in first.outputs] == ["y", "on", "n", "mode"]
    # What the FMU starts with anyway (count, b's k) is not written.
    assert first.start == {"k": 3.0, "flag": 1.0, "state": 3.0, "u": 0.5}
    assert first.texts == {"text": "<&>"}
    assert second.start == {}
    found = {(w.target, w.target_variable): w for w in again.wires}
    assert len(found) == 7
    for wire in system.wires:
        same = found[wire.target.replace(".", "_"), wire.target_variable]
        # 3.6 is what km/h and m/s do by themselves; that is not written, and computed again.
        assert same.factor == pytest.approx(wire.factor, rel=1e-15)
        assert same.offset == wire.offset
        assert dict(wire.items).items() <= dict(same.items).items() or not wire.items


def test_writing_again_gives_the_same_bytes(tmp_path):
    system, one = full_system(tmp_path)
    first = written(tmp_path, system)
    second = written(tmp_path, read_again(tmp_path, first, one), "second")
    assert second.read_bytes() == first.read_bytes()


def test_units_do_by_themselves_what_they_can(tmp_path):
    system, _ = full_system(tmp_path)
    text = text_of(written(tmp_path, system))
    (line,) = [line for line in text.splitlines() if 'endConnector="u"' in line]
    assert "suppressUnitConversion" not in line
    assert 'factor="0.2777777777777778"' in text


def test_conversions_of_elements_are_written_as_the_fmus_see_them(tmp_path):
    one = plant(tmp_path)
    kmh = {"u": Conversion(1 / 3.6), "k": Conversion(1 / 3.6)}
    a = element("a", one, [], ["y"])
    b = element("b", one, ["u"], [], {"k": 10.0}, conversions=kmh)
    system = SystemStructure("s", (a, b), (Wire("a", "y", "b", "u"),))
    path = written(tmp_path, system)
    assert "suppressUnitConversion" not in text_of(path)
    again = read_again(tmp_path, path, one)
    # In SI outside before, in the FMU's own unit now.
    assert again.wires[0].factor == pytest.approx(3.6, rel=1e-15)
    assert again.element("b").start["k"] == pytest.approx(36.0, rel=1e-15)
    assert written(tmp_path, again, "second").read_bytes() == path.read_bytes()


def test_two_fmus_of_one_name_are_kept_apart(tmp_path):
    other = tmp_path / "other"
    other.mkdir()
    one = fmu(tmp_path, "plant", variable("y", "output"))
    two = replace(fmu(other, "plant", variable("y", "output")), content_hash="zzz")
    (other / "plant.fmu").write_bytes(b"the other")
    system = SystemStructure("s", (element("a", one, [], ["y"]), element("b", two, [], ["y"])), ())
    with zipfile.ZipFile(written(tmp_path, system)) as archive:
        assert archive.read("resources/plant.fmu") == b"plant"
        assert archive.read("resources/plant_2.fmu") == b"the other"


def test_names_that_become_equal_are_numbered(tmp_path):
    one = fmu(tmp_path, "one", variable("y", "output"))
    names = ["a.b", "a_b", "a-b"]
    system = SystemStructure("s", tuple(element(name, one, [], ["y"]) for name in names), ())
    ssp = open_ssp(written(tmp_path, system), tmp_path / "unpacked")
    assert list(ssp.places) == ["a_b", "a_b_2", "a_b_3"]


def test_what_only_ssp_2_knows_makes_it_ssp_2(tmp_path):
    plain = [variable("y", "output"), variable("u", "input")]
    one = fmu(tmp_path, "one", *plain, version=3)
    system = SystemStructure("s", (element("a", one, ["u"], ["y"]),), (Wire("a", "y", "a", "u"),))
    assert 'version="1.0"' in text_of(written(tmp_path, system))
    arrays = [
        variable("y", "output", shape=(2, 2), sized_by=("n", "")),
        variable("v", "parameter", shape=(3,), sized_by=("",), start=("0",)),
        variable("n", "structuralParameter", Kind.INTEGER, start=("2",), fmi_type="UInt64"),
        variable("u", "input"),
        variable("i", "input", Kind.INTEGER, fmi_type="UInt8"),
    ]
    two = fmu(tmp_path, "two", *arrays, version=3)
    start = {"v[1]": 1.0, "v[2]": 2.0, "v[3]": 3.0, "i": 200.0}
    system = SystemStructure("s", (element("a", two, ["u"], ["y"], start),), (Wire("a", "y[2,1]", "a", "u"),))
    path = written(tmp_path, system)
    assert text_of(path).count('version="2.0"') == 2
    again = read_again(tmp_path, path, two)
    assert again.wires == system.wires
    assert again.element("a").start == start
    assert written(tmp_path, again, "second").read_bytes() == path.read_bytes()


def test_an_fmu_that_is_gone_and_a_folder_that_is_not_there_are_told(tmp_path):
    one = fmu(tmp_path, "one", variable("y", "output"))
    system = SystemStructure("s", (element("a", one, [], ["y"]),), ())
    with pytest.raises(DseError, match="cannot write"):
        write_ssp(tmp_path / "nowhere" / "x.ssp", "x", system, EXPERIMENT)
    one.archive.unlink()
    with pytest.raises(DseError, match=r"one.fmu cannot be read"):
        write_ssp(tmp_path / "x.ssp", "x", system, EXPERIMENT)


def test_what_is_beyond_the_range_of_numbers_is_refused(tmp_path):
    one = fmu(tmp_path, "one", variable("u", "input"), variable("y", "output"), variable("k", "parameter"))
    small = Conversion(1e-300)
    a = element("a", one, [], ["y"])
    b = element("b", one, ["u"], conversions={"u": small})
    with pytest.raises(DseError, match=r"a.y -> b.u: its factor and offset are beyond the range of numbers"):
        written(tmp_path, SystemStructure("s", (a, b), (Wire("a", "y", "b", "u", 1e300),)))
    c = element("c", one, start={"k": 1e300}, conversions={"k": small})
    with pytest.raises(DseError, match=r"c.k: 1e\+300 is beyond the range of numbers"):
        written(tmp_path, SystemStructure("s", (c,), ()))


FINITE = st.floats(allow_nan=False, allow_infinity=False, width=64)
FACTORS = st.floats(1e-6, 1e6)
CONVERSIONS = st.one_of(st.just(Conversion()), st.builds(Conversion, FACTORS, st.floats(-100, 100)))


@settings(max_examples=60, deadline=None)
@given(factor=FACTORS, offset=st.floats(-1e200, 1e200), start=FINITE, source=CONVERSIONS, target=CONVERSIONS)
def test_any_numbers_survive(tmp_path_factory, factor, offset, start, source, target):
    folder = tmp_path_factory.mktemp("any")
    one = fmu(folder, "one", variable("u", "input"), variable("y", "output"), variable("k", "parameter", start=("0",)))
    a = element("a", one, [], ["y"], conversions={"y": source})
    b = element("b", one, ["u"], [], {"k": start}, conversions={"u": target})
    system = SystemStructure("s", (a, b), (Wire("a", "y", "b", "u", factor, offset),))
    path = written(folder, system)
    again = read_again(folder, path, one)
    assert again.element("b").start.get("k", 0.0) == start
    # A value of the source FMU arrives as the same value in the target FMU, rounded a few times on each way.
    outside = source.factor * 2.0 + source.offset
    there = (factor * outside + offset - target.offset) / target.factor
    scale = (
        abs(factor) * (abs(source.factor * 2.0) + abs(source.offset)) + abs(offset) + abs(target.offset)
    ) / target.factor
    assert abs(again.wires[0].factor * 2.0 + again.wires[0].offset - there) <= 1e-12 * scale
    assert written(folder, again, "second").read_bytes() == path.read_bytes()
