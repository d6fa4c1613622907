"""Archives that come from anywhere: what can be used is described, what cannot is refused, safely and by name."""

from __future__ import annotations

import errno
import os
import stat
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from dse.domain.component import Kind
from dse.errors import DseError
from dse.fmu.build import build
from dse.fmu.description import read_description
from dse.fmu.platforms import this_platform
from dse.fmu.unpack import open_fmu

FMI_2 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="{g}" generationTool="Maker 1.0">
  <CoSimulation modelIdentifier="m" canBeInstantiatedOnlyOncePerProcess="true"/>
  <TypeDefinitions>
    <SimpleType name="Length"><Real unit="m"/></SimpleType>
    <SimpleType name="Gear"><Enumeration><Item name="P" value="1"/></Enumeration></SimpleType>
  </TypeDefinitions>
  <DefaultExperiment stepSize="0.002"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="1" causality="output"><Real declaredType="Length"/></ScalarVariable>
    <ScalarVariable name="v" valueReference="1"><Real unit="m/s" start="2.5"/></ScalarVariable>
    <ScalarVariable name="gear" valueReference="0" causality="input">
      <Enumeration declaredType="Gear" start="1"/>
    </ScalarVariable>
    <ScalarVariable name="file" valueReference="0" causality="parameter"><String start="a.txt"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>
"""

FMI_3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="{g}">
  <CoSimulation modelIdentifier="m" fixedInternalStepSize="0.01" canGetAndSetFMUState="true"/>
  <TypeDefinitions><Float64Type name="Length" unit="m"/></TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="x" valueReference="1" causality="output" declaredType="Length"/>
    <Float32 name="y" valueReference="2" start="0.5"/>
    <UInt16 name="n" valueReference="3"/>
    <String name="file" valueReference="4" causality="parameter"><Start value="a.txt"/></String>
    <Clock name="tick" valueReference="5" causality="input"/>
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>
"""


@dataclass
class Maker:
    """Writes FMUs by hand. The library is an empty file: nothing here loads it."""

    folder: Path
    extra: dict[str, bytes] = field(default_factory=dict)

    def make(self, description: str | bytes | None, library: str | None = None, **options) -> Path:
        version = 3 if description and 'fmiVersion="3' in str(description) else 2
        contents = dict(self.extra)
        if description is not None:
            contents["modelDescription.xml"] = description.encode() if isinstance(description, str) else description
        contents[library or str(this_platform().library(version, "m"))] = b""
        archive = self.folder / "m.fmu"
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as opened:
            for name, content in contents.items():
                opened.writestr(name, content)
        return archive


@pytest.fixture
def maker(tmp_path):
    return Maker(tmp_path)


@pytest.fixture
def refused(tmp_path):
    """What is wrong with an archive: every problem's text, each located at the archive."""

    def problems(archive):
        with pytest.raises(DseError) as caught:
            open_fmu(archive, cache=tmp_path / "cache")
        assert {str(problem.where) for problem in caught.value.problems} == {str(archive)}
        unpacked = tmp_path / "cache" / "unpacked"
        assert not unpacked.exists() or not [path for path in unpacked.iterdir() if path.suffix == ".tmp"]
        return [problem.what for problem in caught.value.problems]

    return problems


def test_an_fmi_2_description_gives_every_scalar_variable(maker, tmp_path):
    model = open_fmu(maker.make(FMI_2), cache=tmp_path / "cache")
    shown = {v.name: (v.reference, v.fmi_type, v.causality, v.kind, v.unit, v.start) for v in model.variables.values()}
    assert shown == {
        "x": (1, "Real", "output", Kind.REAL, "m", None),
        "v": (1, "Real", "local", Kind.REAL, "m/s", "2.5"),
        "gear": (0, "Integer", "input", Kind.ENUMERATION, "", "1"),
        "file": (0, "String", "parameter", None, "", "a.txt"),
    }
    assert (model.version, model.identifier, model.token, model.once_per_process) == (2, "m", "{g}", True)
    assert (model.can_handle_variable_step, model.can_save_state, model.fixed_step) == (False, False, 0.002)


def test_an_fmi_3_description_gives_every_scalar_variable(maker, tmp_path):
    model = open_fmu(maker.make(FMI_3), cache=tmp_path / "cache")
    shown = {v.name: (v.reference, v.fmi_type, v.causality, v.kind, v.unit, v.start) for v in model.variables.values()}
    assert shown == {
        "time": (0, "Float64", "independent", Kind.REAL, "", None),
        "x": (1, "Float64", "output", Kind.REAL, "m", None),
        "y": (2, "Float32", "local", Kind.REAL, "", "0.5"),
        "n": (3, "UInt16", "local", Kind.INTEGER, "", None),
        "file": (4, "String", "parameter", None, "", "a.txt"),
        "tick": (5, "Clock", "input", None, "", None),
    }
    assert (model.version, model.can_save_state, model.fixed_step) == (3, True, 0.01)


def test_an_archive_is_unpacked_once_and_known_by_its_content(maker, tmp_path):
    archive = maker.make(FMI_2)
    first = open_fmu(archive, cache=tmp_path / "cache")
    (first.folder / "left by the first").touch()
    moved = archive.rename(tmp_path / "other.fmu")
    second = open_fmu(moved, cache=tmp_path / "cache")
    assert (second.folder, second.content_hash) == (first.folder, first.content_hash)
    assert second.archive == moved
    assert (second.folder / "left by the first").exists()


def test_an_fmi_2_fmu_may_name_its_platform_as_fmi_3_does(maker, tmp_path):
    library = f"binaries/{this_platform().name}/m{this_platform().suffix}"
    assert open_fmu(maker.make(FMI_2, library), cache=tmp_path / "cache").library.is_file()


def test_a_file_that_is_not_there_or_no_archive_is_told(refused, tmp_path):
    assert refused(tmp_path / "gone.fmu") == ["there is no such file"]
    folder = tmp_path / "folder.fmu"
    folder.mkdir()
    (what,) = refused(folder)
    assert what.startswith("cannot be read: ")
    text = tmp_path / "text.fmu"
    text.write_text("not a zip", encoding="utf-8")
    assert refused(text) == ["is not a complete zip file: File is not a zip file"]


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_a_truncated_archive_is_told(workshop, cache, refused, tmp_path, share):
    content = build(workshop.counter(), cache=cache).read_bytes()
    cut = tmp_path / "cut.fmu"
    cut.write_bytes(content[: int(len(content) * share)])
    (what,) = refused(cut)
    assert what.startswith("is not a complete zip file: ")


def test_a_damaged_entry_is_told(workshop, cache, refused, tmp_path):
    content = bytearray(build(workshop.counter(), cache=cache).read_bytes())
    place = content.index(b"counter_init")
    content[place] ^= 0xFF
    damaged = tmp_path / "damaged.fmu"
    damaged.write_bytes(content)
    (what,) = refused(damaged)
    assert "Bad CRC-32" in what


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("../evil.txt", "leads out of the FMU"),
        ("resources/../../evil.txt", "leads out of the FMU"),
        ("/var/evil.txt", "is absolute"),
        ("C:/evil.txt", "is absolute"),
        ("c:evil.txt", "is absolute"),
        ("resources\\..\\..\\evil.txt", "a character that is not portable"),
    ],
)
def test_a_path_that_leads_out_is_refused_and_nothing_is_written(maker, refused, tmp_path, name, reason):
    maker.extra[name] = b"evil"
    (what,) = refused(maker.make(FMI_2))
    assert what.startswith("refused as unsafe: ")
    assert reason in what
    assert not list(tmp_path.rglob("evil*"))


def test_a_link_in_the_archive_is_refused(maker, refused):
    archive = maker.make(FMI_2)
    with zipfile.ZipFile(archive, "a") as opened:
        link = zipfile.ZipInfo("resources")
        link.create_system = 3
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        opened.writestr(link, "/etc")
    assert refused(archive) == ["refused as unsafe: 'resources' is a link"]


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize("name", ["modelDescription.xml", "modelDescription.xml/inside"])
def test_a_path_that_is_there_twice_is_refused(maker, refused, name):
    archive = maker.make(FMI_2)
    with zipfile.ZipFile(archive, "a") as opened:
        opened.writestr(name, "again")
    assert refused(archive) == [f"refused as unsafe: the path '{name}' is there twice"]


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize(
    "name", ["./modelDescription.xml", "MODELDESCRIPTION.xml", "modelDescription.xml/", "Binaries"]
)
def test_a_path_that_a_file_system_takes_for_another_is_refused(maker, refused, name):
    archive = maker.make(FMI_2)
    with zipfile.ZipFile(archive, "a") as opened:
        opened.writestr(name, "")
    assert refused(archive) == [f"refused as unsafe: the path '{name}' is there twice"]


def test_folders_may_have_entries_of_their_own(maker, tmp_path):
    maker.extra |= {"resources/": b"", "resources/a/": b"", "resources/a/b.txt": b"b", "./resources/c.txt": b"c"}
    folder = open_fmu(maker.make(FMI_2), cache=tmp_path / "cache").folder
    assert (folder / "resources/a/b.txt").read_bytes() + (folder / "resources/c.txt").read_bytes() == b"bc"


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("resources/" + "a" * 300, "holds a name of more than 200 bytes"),
        ("resources/" + "ä" * 150, "holds a name of more than 200 bytes"),
        ("/".join(["resources"] * 200), "is longer than 1000 characters"),
        ("resources/CON", "reserved on Windows"),
        ("aux.txt/a", "reserved on Windows"),
        ("resources/a.", "reserved on Windows"),
    ],
)
def test_a_name_that_some_file_system_cannot_hold_is_refused(maker, refused, name, reason):
    maker.extra[name] = b""
    (what,) = refused(maker.make(FMI_2))
    assert what.startswith("refused as unsafe: ")
    assert reason in what


@pytest.mark.parametrize(("code", "blamed"), [(errno.ENAMETOOLONG, "m.fmu"), (errno.ENOSPC, "cache")])
def test_what_cannot_be_unpacked_is_blamed_on_the_archive_or_the_cache(maker, tmp_path, monkeypatch, code, blamed):
    real = Path.open

    def refuse(self, mode="r", *arguments, **options):
        if mode == "xb":
            raise OSError(code, os.strerror(code))
        return real(self, mode, *arguments, **options)

    archive = maker.make(FMI_2)
    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(DseError) as caught:
        open_fmu(archive, cache=tmp_path / "cache")
    (problem,) = caught.value.problems
    assert blamed in (str(problem.where) if problem.where else problem.what)


def test_an_archive_is_named_as_a_person_here_would(maker, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(DseError, match=r"^m\.fmu: "):
        open_fmu(maker.make("<a/>"), cache=tmp_path / "cache")


def test_a_zip_bomb_is_refused_unpacked(maker, refused):
    maker.extra["resources/zeros"] = bytes(64 * 2**20)
    assert refused(maker.make(FMI_2)) == [
        "refused as unsafe: 'resources/zeros' unpacks to more than 200 times its size"
    ]


def test_an_entry_larger_than_it_claims_is_refused(maker, refused, tmp_path):
    maker.extra["resources/liar"] = os.urandom(5000)
    archive = maker.make(FMI_2)
    content = archive.read_bytes()
    archive.write_bytes(content.replace((5000).to_bytes(4, "little"), (10).to_bytes(4, "little")))
    (what,) = refused(archive)
    assert "zip file" in what or "larger than it claims" in what


def test_without_a_description_it_is_no_fmu(maker, refused):
    assert refused(maker.make(None)) == ["there is no modelDescription.xml in it, so it is not an FMU"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "modelDescription.xml is not XML: no element found: line 1, column 0"),
        ("<fmiModelDescription>", "modelDescription.xml is not XML: no element found: line 1, column 21"),
        ("<a/>", "modelDescription.xml does not describe an FMU: its root is not fmiModelDescription"),
        (b"\xff\xfe\x00", "modelDescription.xml is not XML: "),
        ('<?xml version="1.0" encoding="klingon"?><a/>', "modelDescription.xml is not XML: "),
    ],
)
def test_what_is_not_a_description_is_told(maker, refused, text, message):
    (what,) = refused(maker.make(text))
    assert what.startswith(message)


BOMB = '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "aaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><fmiModelDescription/>'
OUTSIDE = '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><fmiModelDescription/>'
PLAIN_DTD = '<?xml version="1.0"?><!DOCTYPE fmiModelDescription SYSTEM "x.dtd"><fmiModelDescription/>'


@pytest.mark.parametrize("text", [BOMB, OUTSIDE, PLAIN_DTD])
def test_entities_and_document_types_are_refused_as_unsafe(maker, refused, text):
    assert refused(maker.make(text)) == [
        "modelDescription.xml declares a document type or entities, which is refused as unsafe"
    ]


CO_SIMULATION_2 = '<CoSimulation modelIdentifier="m" canBeInstantiatedOnlyOncePerProcess="true"/>'
CO_SIMULATION_3 = '<CoSimulation modelIdentifier="m" fixedInternalStepSize="0.01" canGetAndSetFMUState="true"/>'
Y = 'name="y" valueReference="2" start="0.5"/>'
ARRAY = 'name="y" valueReference="2"><Dimension start="3"/></Float32>'

REFUSALS = {
    "the FMU is of FMI 1.0, which is not supported": (FMI_2, '"2.0"', '"1.0"'),
    "the FMU is of the unknown FMI version '4.0'": (FMI_2, '"2.0"', '"4.0"'),
    "the FMU is for model exchange only, which is not supported": (
        FMI_2,
        CO_SIMULATION_2,
        '<ModelExchange modelIdentifier="m"/>',
    ),
    "the FMU is for scheduled execution only, which is not supported": (
        FMI_3,
        CO_SIMULATION_3,
        '<ScheduledExecution modelIdentifier="m"/>',
    ),
    "modelDescription.xml has no CoSimulation element": (FMI_2, CO_SIMULATION_2, ""),
    "the FMU needs an execution tool: it only connects to 'Maker 1.0'": (
        FMI_2,
        'modelIdentifier="m"',
        'modelIdentifier="m" needsExecutionTool="true"',
    ),
    "modelDescription.xml: '../../m' is not a modelIdentifier": (FMI_2, 'Identifier="m"', 'Identifier="../../m"'),
    "modelDescription.xml: there is no guid": (FMI_2, 'guid="{g}"', ""),
    "modelDescription.xml: there is no instantiationToken": (FMI_3, 'instantiationToken="{g}"', ""),
    "variable 'y' is an array, which is not supported": (FMI_3, Y, ARRAY),
    "modelDescription.xml: variable 'x' is there twice": (FMI_2, 'name="v"', 'name="x"'),
    "modelDescription.xml: variable 'v' has no name or no proper value reference": (
        FMI_2,
        'name="v" valueReference="1"',
        'name="v" valueReference="-1"',
    ),
    "modelDescription.xml: variable 'file' has no type this program knows": (
        FMI_2,
        '<String start="a.txt"/>',
        "<Text/>",
    ),
}


@pytest.mark.parametrize("message", REFUSALS)
def test_what_cannot_be_simulated_is_refused_by_name(maker, refused, message):
    text, old, new = REFUSALS[message]
    assert old in text
    assert refused(maker.make(text.replace(old, new, 1))) == [message]


def test_everything_that_is_wrong_is_told_at_once(maker, refused):
    text = FMI_2.replace('guid="{g}"', "").replace('name="v"', 'name="x"')
    assert len(refused(maker.make(text))) == 2


def test_a_missing_library_is_told_with_those_that_are_there(maker, refused):
    library = f"'m{this_platform().suffix}' for this platform, {this_platform().name}"
    assert refused(maker.make(FMI_2, "binaries/amiga/m.so")) == [
        f"the FMU has no library {library}; it has libraries for amiga"
    ]
    assert refused(maker.make(FMI_2, "sources/m.c")) == [
        f"the FMU has no library {library}; it has no libraries at all"
    ]


def test_a_description_in_a_folder_is_located_at_its_file(tmp_path):
    (tmp_path / "modelDescription.xml").write_text("<a/>", encoding="utf-8")
    with pytest.raises(DseError, match=r"modelDescription\.xml: modelDescription\.xml does not describe an FMU"):
        read_description(tmp_path)
