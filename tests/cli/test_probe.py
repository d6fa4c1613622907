"""`dse probe` as a user runs it, and what the other commands do with what it found."""

from __future__ import annotations

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from command_line import run_dse

from dse.cache import put_file
from dse.fmu.toolchain.compiler import find_compiler

ODD = Path(__file__).parents[1] / "cosim" / "probing" / "fmus" / "odd.c"

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="odd" guid="the token">
  <CoSimulation modelIdentifier="odd" canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true"/>
  <DefaultExperiment startTime="0" stopTime="0.2" stepSize="0.01"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="k" valueReference="1" causality="parameter"><Real start="2"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="n" valueReference="3" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="3"/><Unknown index="4"/></Outputs></ModelStructure>
</fmiModelDescription>
"""


def odd_fmu(folder: Path, *flags: str) -> Path:
    """A real archive of odd.c, compiled with *flags*."""
    library = folder / "odd.library"
    fpic = [] if sys.platform == "win32" else ["-fPIC"]
    command = [*find_compiler().command, "-std=gnu11", "-O1", *fpic, "-shared", "-DFMI=2", *(f"-D{f}" for f in flags)]
    subprocess.run([*command, str(ODD), "-o", str(library)], check=True)
    place = {"win32": "win64/odd.dll", "darwin": "darwin64/odd.dylib"}.get(sys.platform, "linux64/odd.so")
    archive = folder / "_".join(("odd", *(flag.split("=")[0].lower() for flag in flags)))
    with zipfile.ZipFile(f"{archive}.fmu", "w") as opened:
        opened.writestr("modelDescription.xml", DESCRIPTION)
        opened.write(library, f"binaries/{place}")
    return Path(f"{archive}.fmu")


def probe(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return run_dse(Path(__file__).parents[2], "probe", *arguments, cache=folder / "cache")


@pytest.mark.thorough
def test_the_answers_are_shown_with_what_follows_from_them(tmp_path: Path):
    fmu = odd_fmu(tmp_path, "KEEPS_PARAMETERS")
    done = probe(tmp_path, str(fmu))
    assert done.returncode == 0, done.stderr
    lines = [line.rstrip() for line in done.stdout.splitlines()]
    assert lines[0].endswith("FMI 2, CoSimulation, 20 steps of 0.01 s")
    assert any(line.split()[:5] == ["reset", "equals", "fresh", "no", "y"] for line in lines)
    assert "  → is made anew before every run, never reset" in lines
    assert any(line.split()[:7] == ["its", "own", "error", "can", "be", "measured", "no"] for line in lines)


@pytest.mark.thorough
def test_what_was_found_is_taken_from_the_cache_until_it_is_asked_for_again(tmp_path: Path):
    fmu = odd_fmu(tmp_path)
    first = json.loads(probe(tmp_path, str(fmu), "--format", "json").stdout)
    second = json.loads(probe(tmp_path, str(fmu), "--format", "json").stdout)
    assert first == second
    (facts,) = first
    assert facts["answers"]["resets"] == "yes"
    assert facts["reasons"] == {}
    assert (facts["numerics"]["changes"], facts["numerics"]["inner_step"]) == ({}, None)
    assert facts["numerics"]["unknown"].startswith("neither other steps nor another tolerance")
    assert len(list((tmp_path / "cache" / "numerics").glob("*.json"))) == 1
    (file,) = (tmp_path / "cache" / "facts").glob("*.json")
    put_file(file, file.read_bytes().replace(b'"resets": "yes"', b'"resets": "no"'))
    assert json.loads(probe(tmp_path, str(fmu), "--format", "json").stdout)[0]["answers"]["resets"] == "no"
    again = json.loads(probe(tmp_path, str(fmu), "--format", "json", "--again").stdout)
    assert again[0]["answers"]["resets"] == "yes"


@pytest.mark.thorough
def test_an_fmu_that_does_not_run_is_told_of_and_the_next_one_is_probed(tmp_path: Path):
    bad, good = odd_fmu(tmp_path, "INITIALIZATION_HANGS"), odd_fmu(tmp_path)
    done = probe(tmp_path, str(bad), str(good), "--timeout", "1")
    assert done.returncode == 3
    assert "no answer for 1 s while initializing" in done.stdout
    assert done.stdout.count("yes") >= 10


@pytest.mark.parametrize(
    ("name", "message"), [("nothing.fmu", "there is no such file"), ("no_such_part", "no_such_part")]
)
def test_what_is_not_there_is_a_located_problem(tmp_path: Path, name: str, message: str):
    done = probe(tmp_path, name)
    assert done.returncode == 1
    assert message in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.thorough
def test_a_component_of_the_workspace_is_built_and_probed(tmp_path: Path):
    done = probe(tmp_path, "pd_acc", "--format", "json")
    assert done.returncode == 0, done.stderr
    (facts,) = json.loads(done.stdout)
    assert facts["answers"] | {"feeds through": "?", "saves": "?", "serializes": "?"} == dict.fromkeys(
        facts["answers"], "yes"
    ) | {"feeds through": "?", "saves": "?", "serializes": "?"}


@pytest.mark.thorough
def test_threads_give_the_same_study_as_processes(dse, explored: Path, tmp_path: Path):
    done = dse("explore", "small", "-o", str(tmp_path / "threads"), "--workers", "1", "--threads", "2", "--fresh")
    assert done.returncode == 0, done.stderr
    tables = [dse("results", str(folder)).stdout for folder in (explored, tmp_path / "threads")]
    assert tables[0] == tables[1]
    files = [
        {f.name: f.read_bytes() for f in (folder / "waveforms").iterdir()}
        for folder in (explored, tmp_path / "threads")
    ]
    assert files[0] == files[1]
