"""Archives that come from anywhere: what can be used is described, what cannot is refused, safely and by name."""

from __future__ import annotations

import errno
import os
import shutil
import stat
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from fmu.descriptions import FMI_1

from dse.cache import CacheWarning
from dse.errors import DseError
from dse.fmu.component_build import build
from dse.fmu.toolchain.platforms import this_platform
from dse.fmu.unpack import open_fmu

FMI_2 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="{g}">
  <CoSimulation modelIdentifier="m"/>
  <ModelVariables>
    <ScalarVariable name="x" valueReference="1" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>
"""


@dataclass
class Maker:
    """Writes FMUs by hand. The library is an empty file: nothing here loads it."""

    folder: Path
    extra: dict[str, bytes] = field(default_factory=dict)

    def make(self, description: str | bytes | None, library: str | None = None) -> Path:
        contents = dict(self.extra)
        if description is not None:
            contents["modelDescription.xml"] = description.encode() if isinstance(description, str) else description
        contents[library or str(this_platform().library(2, "m"))] = b""
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
        places = {str(archive), f"{archive}/modelDescription.xml"}
        assert {problem.where.file for problem in caught.value.problems} <= places
        unpacked = tmp_path / "cache" / "unpacked"
        assert not unpacked.exists() or not [path for path in unpacked.iterdir() if path.suffix == ".tmp"]
        return [problem.what for problem in caught.value.problems]

    return problems


def test_an_archive_is_unpacked_once_and_known_by_its_content(maker, tmp_path):
    archive = maker.make(FMI_2)
    first = open_fmu(archive, cache=tmp_path / "cache")
    unpacked = (first.folder / "modelDescription.xml").stat()
    moved = archive.rename(tmp_path / "other.fmu")
    second = open_fmu(moved, cache=tmp_path / "cache")
    assert (second.folder, second.content_hash) == (first.folder, first.content_hash)
    assert second.archive == moved
    assert (second.folder / "modelDescription.xml").stat().st_ino == unpacked.st_ino


def gone(folder):
    shutil.rmtree(folder)


def cut_short(folder):
    library = next(folder.rglob(f"*{this_platform().suffix}"))
    os.truncate(library, library.stat().st_size // 2)


@pytest.mark.parametrize("damage", [gone, cut_short])
def test_an_fmu_that_harmed_its_folder_is_unpacked_again(workshop, tmp_path, damage):
    archive = build(workshop.counter(), cache=tmp_path)
    before = open_fmu(archive, cache=tmp_path)
    library = before.library.read_bytes()
    damage(before.folder)
    with pytest.warns(CacheWarning, match="unpacked"):
        assert open_fmu(archive, cache=tmp_path) == before
    assert before.library.read_bytes() == library


def test_an_fmi_2_fmu_may_name_its_platform_as_fmi_3_does(maker, tmp_path):
    library = f"binaries/{this_platform().name}/m{this_platform().suffix}"
    assert open_fmu(maker.make(FMI_2, library), cache=tmp_path / "cache").library.is_file()


def test_an_fmu_of_fmi_1_names_its_platform_as_fmi_2_does(maker, tmp_path):
    archive = maker.make(FMI_1, f"binaries/{this_platform().short_name}/m{this_platform().suffix}")
    model = open_fmu(archive, cache=tmp_path / "cache")
    assert (model.version, model.library.is_file()) == (1, True)


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
        ("resources\\..\\..\\evil.txt", "leads out of the FMU"),
        ("\\evil.txt", "is absolute"),
        ("C:\\evil.txt", "is absolute"),
    ],
)
def test_a_path_that_leads_out_is_refused_and_nothing_is_written(maker, refused, tmp_path, name, reason):
    maker.extra[name] = b"evil"
    (what,) = refused(maker.make(FMI_2))
    assert what.startswith("refused as unsafe: ")
    assert reason in what
    assert not list(tmp_path.rglob("evil*"))


def test_paths_with_backslashes_are_those_with_slashes(maker, tmp_path):
    maker.extra["extra\\org.example\\notes.txt"] = b"written on Windows"
    model = open_fmu(maker.make(FMI_2), cache=tmp_path / "cache")
    assert (model.folder / "extra" / "org.example" / "notes.txt").read_bytes() == b"written on Windows"
    assert [p.what for p in model.ignored] == ["paths are written with backslashes, as 'extra\\org.example\\notes.txt'"]


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


@pytest.mark.parametrize("name", ["", "."])
def test_an_entry_without_a_name_is_refused(maker, refused, name):
    archive = maker.make(FMI_2)
    with zipfile.ZipFile(archive, "a") as opened:
        opened.writestr(zipfile.ZipInfo(name), "content")
    assert refused(archive) == ["refused as unsafe: a file has no name"]


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
    ],
)
def test_a_name_that_some_file_system_cannot_hold_is_refused(maker, refused, name, reason):
    maker.extra[name] = b""
    (what,) = refused(maker.make(FMI_2))
    assert what.startswith("refused as unsafe: ")
    assert reason in what


@pytest.mark.skipif(os.name == "nt", reason="there no file can have such a name")
@pytest.mark.parametrize("name", ["resources/CON", "aux.txt/a", "resources/a."])
def test_a_name_that_another_system_cannot_hold_is_unpacked_and_told(maker, tmp_path, name):
    maker.extra[name] = b"there"
    for _ in range(2):  # the second time from the cache
        model = open_fmu(maker.make(FMI_2), cache=tmp_path / "cache")
        assert (model.folder / name).read_bytes() == b"there"
        assert [problem.what for problem in model.ignored] == [
            f"the path '{name}' holds a name that is reserved on Windows"
        ]


LOCAL = '<ScalarVariable name="z" valueReference="{}" causality="{}"><Real/></ScalarVariable>'


def with_two(first: str, second: str) -> str:
    added = LOCAL.format(2, first) + "\n" + LOCAL.format(3, second)
    return FMI_2.replace("  </ModelVariables>", f"{added}\n  </ModelVariables>")


def test_an_internal_variable_that_is_there_twice_cannot_be_used_and_is_told(maker, tmp_path):
    model = open_fmu(maker.make(with_two("local", "local")), cache=tmp_path / "cache")
    assert list(model.variables) == ["x"]
    (told,) = model.ignored
    assert str(told).endswith(
        "m.fmu/modelDescription.xml:7:1: the internal variable 'z' is there twice, so that it cannot be used"
    )


@pytest.mark.parametrize("pair", [("local", "output"), ("input", "local"), ("input", "input")])
def test_a_variable_that_may_be_connected_is_there_once(maker, refused, pair):
    assert refused(maker.make(with_two(*pair))) == ["variable 'z' is there twice"]


def test_a_prefix_in_an_annotation_may_be_bound_to_nothing(maker, tmp_path):
    noted = '<VendorAnnotations><Tool name="x"><x:y/></Tool></VendorAnnotations></fmiModelDescription>'
    model = open_fmu(maker.make(FMI_2.replace("</fmiModelDescription>", noted)), cache=tmp_path / "cache")
    assert [problem.what for problem in model.ignored] == ["the prefix 'x' is bound to no namespace"]


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_of_two_extra_files_with_one_path_the_first_is_taken(maker, tmp_path):
    archive = maker.make(FMI_2)
    with zipfile.ZipFile(archive, "a") as opened:
        for name, content in (("./", ""), ("extra/a.txt", "first"), ("extra/a.txt", "later"), ("extra/A.txt", "last")):
            opened.writestr(name, content)
    model = open_fmu(archive, cache=tmp_path / "cache")
    assert [path.read_text() for path in (model.folder / "extra").iterdir()] == ["first"]
    assert [problem.what for problem in model.ignored] == [
        "the entry './' is not a file",
        "the path 'extra/a.txt' is there twice, the first is taken",
        "the path 'extra/A.txt' is there twice, the first is taken",
    ]


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize("name", ["extra/../modelDescription.xml", "resources/a.txt"])
def test_a_second_file_that_the_fmu_may_read_is_refused(maker, refused, name):
    maker.extra["resources/a.txt"] = b"first"
    archive = maker.make(FMI_2)
    with zipfile.ZipFile(archive, "a") as opened:
        opened.writestr(name, "again")
        opened.writestr(name, "again")
    assert refused(archive)[0].startswith(f"refused as unsafe: the path '{name}'")


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
    with pytest.raises(DseError, match=r"^m\.fmu/modelDescription\.xml:1:1: "):
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


def test_a_folder_that_was_zipped_with_its_name_is_recognized(maker, tmp_path):
    maker.extra["model/modelDescription.xml"] = FMI_2.encode()
    with pytest.raises(DseError, match="there is one in its folder 'model': zip what is in that folder"):
        open_fmu(maker.make(None), cache=tmp_path / "cache")


def test_a_missing_library_is_told_with_what_is_there_instead(maker, refused):
    platform = this_platform()
    missing = f"the FMU has no library 'm{platform.suffix}' for this platform, {platform.name}; "
    folder = f"binaries/{platform.short_name}"
    assert refused(maker.make(FMI_2, "binaries/amiga/m.so")) == [f"{missing}it has libraries for amiga"]
    assert refused(maker.make(FMI_2, f"{folder}/n{platform.suffix}")) == [
        f"{missing}its folder {folder} holds n{platform.suffix}"
    ]
    assert refused(maker.make(FMI_2, "sources/m.c")) == [
        f"{missing}it has no libraries at all, and does not declare which of its sources are to be compiled"
    ]
