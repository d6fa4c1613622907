"""FMUs with libraries for other platforms: what they contain, and what is refused by name."""

from __future__ import annotations

import importlib.util
import struct
import zipfile

import pytest
from fmpy.validation import validate_fmu
from reference_fmus.build import write_archive

from dse.cosim.probing.probe import probe
from dse.domain.facts import Question
from dse.errors import DseError
from dse.fmu.component_build import _universal, build_all, with_platforms
from dse.fmu.toolchain.platforms import platforms_named
from dse.fmu.unpack import open_fmu

INTEL, ARM = 0x01000007, 0x0100000C


def exported_by_dll(content: bytes) -> set[str]:
    """The names in the export table of a 64-bit library for Windows."""

    def text(place: int) -> str:
        return content[place : content.index(b"\0", place)].decode()

    start = struct.unpack_from("<I", content, 60)[0]
    assert content[start : start + 6] == b"PE\0\0\x64\x86"  # for AMD64
    count, size, magic = struct.unpack_from("<xxxxxxHxxxxxxxxxxxxHxxH", content, start)
    assert magic == 0x20B
    sections = [struct.unpack_from("<8xIIII", content, start + 24 + size + 40 * k) for k in range(count)]

    def place(address: int) -> int:
        return next(raw + address - at for length, at, _, raw in sections if at <= address < at + length)

    table = place(struct.unpack_from("<I", content, start + 24 + 112)[0])
    names = place(struct.unpack_from("<I", content, table + 32)[0])
    return {
        text(place(at))
        for at in struct.unpack_from(f"<{struct.unpack_from('<I', content, table + 24)[0]}I", content, names)
    }


def exported_by_dylib(content: bytes) -> set[str]:
    """The names that macOS finds in a library for one processor: leaves of the trie of LC_DYLD_INFO_ONLY."""
    magic, _, _, kind, count = struct.unpack_from("<5I", content)
    assert (magic, kind) == (0xFEEDFACF, 6)
    place, found = 32, set()
    for _ in range(count):
        command, size = struct.unpack_from("<II", content, place)
        if command == 0x80000022:
            first, length = struct.unpack_from("<II", content, place + 40)
            trie = content[first : first + length]
        place += size
    open_ends = [(0, "")]
    while open_ends:
        at, name = open_ends.pop()
        size = trie[at]
        assert size < 128  # so the number is one byte
        found |= {name.removeprefix("_")} if size else set()
        at += 1 + size
        edges, at = trie[at], at + 1
        for _ in range(edges):
            end = trie.index(b"\0", at)
            step, node, shift = trie[at:end].decode(), 0, 0
            at = end + 1
            while True:
                node |= (trie[at] & 127) << shift
                shift, at = shift + 7, at + 1
                if trie[at - 1] < 128:
                    break
            open_ends.append((node, name + step))
    return found


def parts(content: bytes) -> dict[int, bytes]:
    """The libraries of a universal binary, by processor."""
    magic, count = struct.unpack_from(">II", content)
    assert magic == 0xCAFEBABE
    entries = [struct.unpack_from(">5I", content, 8 + 20 * k) for k in range(count)]
    assert all(at % (1 << power) == 0 for _, _, at, _, power in entries)
    return {processor: content[at : at + size] for processor, _, at, size, _ in entries}


def test_names_of_both_versions_of_fmi_are_platforms():
    assert [p.name for p in platforms_named(["win64", "x86_64-windows"])] == ["x86_64-windows"]
    macs = ["x86_64-darwin", "aarch64-darwin"]
    assert [[p.name for p in platforms_named(names)] for names in (["darwin"], ["darwin64"], macs)] == [macs] * 3
    with pytest.raises(DseError, match=r"'win46' is not a platform that FMUs can be built for\n.*did you mean 'win64'"):
        platforms_named(["linux64", "win46"])


def test_libraries_for_several_processors_are_one_universal_binary():
    one, other = (struct.pack("<III", 0xFEEDFACF, processor, 3) + bytes(size) for processor, size in ((7, 9), (12, 1)))
    assert parts(_universal([one, other])) == {7: one, 12: other}
    assert _universal([one]) == one


def test_without_the_ziglang_package_it_is_said_how_to_get_it(workshop, cache, monkeypatch, version):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(DseError) as refused:
        build_all([workshop.counter()], version=version, cache=cache, platforms=platforms_named(["win64"]))
    assert "the ziglang package, which compiles for x86_64-windows, is not installed" in str(refused.value)
    assert "pip install 'dse-workbench[toolchain]'" in str(refused.value)


def test_an_fmu_that_was_not_built_here_is_refused_unless_it_has_the_library(tmp_path, workshop, cache):
    own = build_all([workshop.counter()], cache=cache)["counter"]
    with zipfile.ZipFile(own) as whole:
        files = {name: whole.read(name) for name in whole.namelist() if not name.startswith("sources/")}
    foreign = write_archive(tmp_path / "foreign.fmu", {**files, "binaries/win64/counter.dll": b"MZ"})
    assert with_platforms("theirs", foreign, platforms_named(["win64", "linux64"]), cache=cache) == foreign
    with pytest.raises(DseError) as refused:
        with_platforms("theirs", foreign, platforms_named(["win64", "darwin"]), cache=cache)
    assert str(refused.value) == (
        "the FMU of 'theirs' cannot be built for x86_64-darwin, aarch64-darwin: it was not built by dse from C or "
        "Modelica"
    )


needs_zig = pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")


@needs_zig
@pytest.mark.thorough  # The first time, ziglang compiles libraries of its own for each platform, which takes minutes.
def test_the_libraries_for_other_platforms_export_the_same_functions(workshop, cache, tmp_path, version):
    others = platforms_named(["win64", "darwin"])
    archive = build_all([workshop.counter()], version=version, cache=cache, platforms=others)["counter"]
    plain = build_all([workshop.counter()], version=version, cache=cache)["counter"]
    with zipfile.ZipFile(archive) as whole, zipfile.ZipFile(plain) as before:
        kept = before.namelist()
        assert [whole.read(name) for name in kept] == [before.read(name) for name in kept]
        added = {name: whole.read(name) for name in whole.namelist() if name not in kept}
    if version == 2:
        macs = parts(added.pop("binaries/darwin64/counter.dylib"))
        dll = added.pop("binaries/win64/counter.dll")
    else:
        macs = {
            processor: added.pop(f"binaries/{name}-darwin/counter.dylib")
            for name, processor in (("x86_64", INTEL), ("aarch64", ARM))
        }
        dll = added.pop("binaries/x86_64-windows/counter.dll")
    assert not added
    assert [struct.unpack_from("<I", macs[processor], 4)[0] for processor in (INTEL, ARM)] == [INTEL, ARM]
    of_windows, *of_macs = (exported_by_dll(dll), *map(exported_by_dylib, macs.values()))
    assert all(name.startswith(f"fmi{version}") for name in of_windows)
    assert len(of_windows) > 30
    # Apple's linker adds two names of its own to every library.
    assert [
        names - {"_mh_dylib_header", "__dso_handle", "__mh_dylib_header", "___dso_handle"} for names in of_macs
    ] == [of_windows] * 2
    assert not any(b"/tmp/" in each or b".cache" in each for each in (dll, *macs.values()))  # no path of this machine
    assert validate_fmu(str(archive)) == []
    assert open_fmu(archive, cache=cache).library.suffix == open_fmu(plain, cache=cache).library.suffix
    again = with_platforms("counter", plain, others, cache=tmp_path / "elsewhere")
    assert again.read_bytes() == archive.read_bytes()


@needs_zig
@pytest.mark.thorough
def test_c_that_does_not_compile_elsewhere_is_located(workshop, cache):
    component = workshop.counter()
    code = component.source.files[0]
    code.write_text(code.read_text("utf-8") + "#ifdef _WIN32\n#error not here\n#endif\n", "utf-8")
    with pytest.raises(DseError, match=r"counter\.c:\d+:2: component 'counter' does not compile for x86_64-windows"):
        build_all([component], cache=cache, platforms=platforms_named(["win64"]))


@needs_zig
@pytest.mark.thorough
def test_the_library_for_windows_runs_in_wine(workshop, tmp_path, wine_cache, version):
    component = workshop.counter()
    archive = build_all([component], version=version, cache=wine_cache, platforms=platforms_named(["win64"]))["counter"]
    with zipfile.ZipFile(archive) as whole:
        kept = [name for name in whole.namelist() if "linux" not in name and not name.startswith("sources/")]
        foreign = write_archive(tmp_path / "foreign.fmu", {name: whole.read(name) for name in kept})
    found = [open_fmu(each, cache=wine_cache) for each in (archive, foreign)]
    assert found[1].host.is_wine
    questions = frozenset({Question.RUNS, Question.REPEATS, Question.RESETS, Question.SAVES, Question.VARIES_STEP})
    here, there = (probe(model, "x86_64", only=questions).answers for model in found)
    assert here == there
    assert here[Question.RUNS] is not None
