"""FMUs that have a library for Windows only: wine runs them, in a process of its own, or it is said what that takes."""

from __future__ import annotations

import re
import time
from pathlib import Path

import psutil
import pytest
from reference_fmus import build
from reference_fmus.build import WINDOWS, write_archive
from zoo.animals import ANIMALS, build_animal

from dse.cosim.binding.calls import FUNCTIONS, AccessorType, Call, function_name
from dse.cosim.probing import experiments
from dse.cosim.probing.child import ProbeLimits, attempt
from dse.cosim.probing.excitation import excitation_of
from dse.cosim.probing.probe import probe
from dse.domain.facts import Question
from dse.errors import DseError
from dse.fmu import windows
from dse.fmu.toolchain.compiler import NoCompilerError
from dse.fmu.toolchain.platforms import this_platform
from dse.fmu.unpack import open_fmu

pytestmark = pytest.mark.skipif(this_platform().name != "x86_64-linux", reason="wine is used there only")

VERSION_1 = """<fmiModelDescription fmiVersion="1.0" modelName="m" modelIdentifier="m" guid="g"
  numberOfContinuousStates="0" numberOfEventIndicators="0">
  <ModelVariables/><Implementation><CoSimulation_StandAlone/></Implementation>
</fmiModelDescription>"""
VERSION_2 = """<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">
  <CoSimulation modelIdentifier="m">{files}</CoSimulation><ModelVariables/>
</fmiModelDescription>"""
SOURCES = '<SourceFiles><File name="m.c"/></SourceFiles>'


def windows_only(folder: Path, description: str = VERSION_2.format(files=""), place: str = "win64") -> Path:
    """An FMU whose library is none."""
    files = {"modelDescription.xml": description.encode(), f"binaries/{place}/m.dll": b"MZ"}
    return write_archive(folder / "m.fmu", files | {"sources/m.c": b"#include <windows.h>\n"})


def refusal(archive: Path, cache: Path) -> str:
    with pytest.raises(DseError) as refused:
        open_fmu(archive, cache=cache)
    return str(refused.value)


def test_without_wine_it_is_said_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(windows, "find_wine", lambda: "")
    told = refusal(windows_only(tmp_path), tmp_path / "cache")
    assert "no library for x86_64-linux, only for Windows, and there is no wine" in told
    assert "apt install wine64" in told


def test_without_a_compiler_for_windows_it_is_said_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(windows, "find_wine", lambda: "/usr/bin/wine64")
    monkeypatch.setattr(windows, "_version_of", lambda _wine: "wine-8.0")
    monkeypatch.setattr(windows, "folder_of_windows", lambda _wine, _cache: tmp_path)
    monkeypatch.setattr("dse.fmu.toolchain.compiler._MINGW", "no-such-compiler")
    real = windows.find_windows_compiler.__globals__["importlib"].util.find_spec
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == "ziglang" else real(name))
    with pytest.raises(NoCompilerError, match="no compiler for Windows programs") as refused:
        open_fmu(windows_only(tmp_path), cache=tmp_path / "cache")
    assert "dse-workbench[toolchain]" in str(refused.value)


@pytest.mark.parametrize(
    ("description", "place", "why"),
    [
        (VERSION_1, "win64", "or in FMI 2.0 or 3.0 (wine is used for those only)"),
        (VERSION_2.format(files=""), "win32", "or for win64 (wine is used for 64-bit libraries"),
    ],
    ids=["FMI 1.0", "32 bits"],
)
def test_what_wine_is_not_used_for_is_refused_by_name(description: str, place: str, why: str, tmp_path: Path) -> None:
    assert why in refusal(windows_only(tmp_path, description, place), tmp_path / "cache")


def test_every_function_that_the_kernel_calls_goes_over_the_bridge() -> None:
    header = (Path(windows.__file__).parent / "bridge" / "functions.h").read_text("utf-8")
    known = set(re.findall(r"\bF\((fmi\w+), ", header))
    for version, kind in re.findall(r"FMI(\d)_ACCESS\(F, (\w+),", header):
        known |= {f"fmi{version}{verb}{kind}" for verb in ("Get", "Set")}
    calls = [*FUNCTIONS, *Call, *(verb + kind for verb in (Call.GET, Call.SET) for kind in AccessorType)]
    wanted = {function_name(call, version) for call in calls for version in (2, 3)} - {""}
    also = {"fmi3InstantiateModelExchange", "fmi2SerializeFMUstate", "fmi3DeserializeFMUState"}
    assert len(wanted) > 80
    assert wanted | also <= known


@pytest.mark.thorough
def test_sources_that_do_not_compile_give_way_to_the_library_and_are_told(tmp_path: Path, wine_cache: Path) -> None:
    model = open_fmu(windows_only(tmp_path, VERSION_2.format(files=SOURCES)), cache=wine_cache)
    assert model.host.command
    assert [p.what for p in model.ignored if "windows.h" in p.what]


@pytest.mark.thorough
def test_what_is_no_library_is_refused_with_the_error_of_windows(tmp_path: Path, wine_cache: Path) -> None:
    outcome = tried(open_fmu(windows_only(tmp_path), cache=wine_cache))
    assert "m: the FMU's library cannot be loaded" in outcome.failure
    assert "of Windows" in outcome.failure


def tried(model, *, sandboxed: bool = False, seconds: float = 60.0):
    limits = ProbeLimits(time=seconds)
    return attempt(experiments.plain_run, model, excitation_of(model), limits=limits, sandboxed=sandboxed)


@pytest.mark.thorough
def test_it_is_refused_in_a_sandbox_by_name(tmp_path: Path, wine_cache: Path) -> None:
    model = open_fmu(build("Dahlquist", 2, "CoSimulation", tmp_path, WINDOWS), cache=wine_cache)
    assert "Dahlquist: an FMU for Windows cannot be run in a sandbox" in tried(model, sandboxed=True).failure
    assert not tried(model).failure


def hosts_of(model) -> list[int]:
    place = model.host.command[-1]
    return [p.pid for p in psutil.process_iter(["cmdline", "status"]) if place in (p.info["cmdline"] or ())]


@pytest.mark.thorough
def test_a_host_that_hangs_ends_with_the_process_that_called_it(tmp_path: Path, wine_cache: Path) -> None:
    archive = build_animal(ANIMALS["hangs_in_instantiate"], tmp_path, "hangs", WINDOWS)
    model = open_fmu(archive, cache=wine_cache)
    outcome = tried(model, seconds=2.0)
    assert outcome.hung
    assert "instantiating" in outcome.failure
    end = time.monotonic() + 60.0
    while hosts_of(model) and time.monotonic() < end:
        time.sleep(0.05)
    assert hosts_of(model) == []


PROVEN = frozenset({
    Question.RUNS, Question.REPEATS, Question.RESETS, Question.RENEWS, Question.COEXISTS, Question.THREADS,
    Question.SAVES, Question.SERIALIZES, Question.VARIES_STEP,
})  # fmt: skip


@pytest.mark.thorough
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_the_probe_finds_the_same_of_it_as_of_the_library_for_linux(
    version: int, interface: str, tmp_path: Path, wine_cache: Path
) -> None:
    found = []
    for platform in (this_platform(), WINDOWS):
        archive = build("BouncingBall", version, interface, tmp_path / platform.name, platform)
        facts = probe(open_fmu(archive, cache=wine_cache), platform.name, only=PROVEN)
        found.append({question: facts.answers.get(question) for question in PROVEN})
    assert found[0] == found[1]
    assert found[0][Question.SAVES] is not None
