"""Each instance has resources of its own: what an FMU writes there is seen by no other, and never in the cache."""

from __future__ import annotations

import sys
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from dse.cache import is_damaged
from dse.cosim.binding.resources import InstanceFolder
from dse.cosim.simulator import Simulator
from dse.fmu import open_fmu

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the FMU that writes is written for POSIX")

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="writer" guid="the token">
  <CoSimulation modelIdentifier="writer" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <ScalarVariable name="y" valueReference="0" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure>
</fmiModelDescription>
"""


@pytest.fixture
def unpacked(tmp_path):
    """The folder of an FMU with resources, as it is in the cache."""
    folder = tmp_path / "unpacked"
    (folder / "resources" / "deep").mkdir(parents=True)
    (folder / "resources" / "count").write_text("7\n", encoding="utf-8")
    (folder / "resources" / "deep" / "table").write_text("1 2 3\n", encoding="utf-8")
    (folder / "modelDescription.xml").write_text("<told/>", encoding="utf-8")
    return folder


@pytest.fixture(autouse=True)
def scratch(tmp_path, monkeypatch):
    """Where temporary folders are made."""
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.mark.parametrize("version", [1, 2, 3])
def test_what_an_instance_writes_is_seen_by_no_other_and_by_none_after_it(shelf, unpacked, scratch, version):
    model = replace(shelf.fmu("writer", version), folder=unpacked)
    system = shelf.system({"a": model, "b": model}, record=["a.y", "b.y"])
    with Simulator(system, ["a.y", "b.y"]) as simulator:
        for _ in range(3):
            assert simulator.run(stop=1.0, step=0.5).tolist() == [[7.0, 7.0]] * 3
        assert len(list(scratch.iterdir())) == 2
    assert (unpacked / "resources" / "count").read_text(encoding="utf-8") == "7\n"
    assert list(scratch.iterdir()) == []


@pytest.mark.parametrize("version", [1, 2, 3])
def test_the_next_instance_begins_with_what_the_archive_holds(shelf, unpacked, version):
    folder = InstanceFolder(replace(shelf.fmu("writer", version), folder=unpacked))
    told = Path(folder.location.removeprefix("file://"))
    resources = told / "resources" if version == 1 else told
    assert (resources.parent / "modelDescription.xml").read_text(encoding="utf-8") == "<told/>"
    for change in (
        lambda: (resources / "new").write_text("x", encoding="utf-8"),
        (resources / "count").unlink,
        lambda: (resources / "deep" / "table").write_text("3 2 1\n", encoding="utf-8"),
        (resources.parent / "modelDescription.xml").unlink,
        lambda: (resources / "deep").rename(resources / "moved"),
    ):
        change()
        folder.renew()
        found = {str(p.relative_to(resources)): p.read_bytes() for p in resources.rglob("*") if p.is_file()}
        assert found == {"count": b"7\n", "deep/table": b"1 2 3\n"}
        assert (resources.parent / "modelDescription.xml").is_file()
    folder.remove()


def test_nothing_is_made_for_an_fmu_without_resources_and_what_it_makes_goes(shelf, unpacked, scratch, tmp_path):
    bare = tmp_path / "bare"
    bare.mkdir()
    model = replace(shelf.fmu("writer", 2, "-DMAKES_FOLDER"), folder=bare)
    with Simulator(shelf.system({"a": model}, record=["a.y"]), ["a.y"]) as simulator:
        simulator.run(stop=1.0, step=0.5)
        assert list(scratch.iterdir()) == []
    assert list(bare.iterdir()) == []


def test_the_cache_is_whole_after_an_fmu_that_writes(shelf, tmp_path):
    library = shelf.fmu("writer", 2).library
    with zipfile.ZipFile(tmp_path / "writer.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.writestr("resources/count", "3")
        archive.write(library, "binaries/linux64/writer.so")
        archive.write(library, "binaries/darwin64/writer.dylib")
    model = open_fmu(tmp_path / "writer.fmu", cache=tmp_path / "cache")
    with Simulator(shelf.system({"a": model}, record=["a.y"]), ["a.y"]) as simulator:
        assert simulator.run(stop=1.0, step=0.5)[-1].tolist() == [3.0]
    assert not is_damaged(model.folder)
