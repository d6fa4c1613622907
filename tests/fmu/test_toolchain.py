"""Which compiler is taken, and what is said when there is none."""

from __future__ import annotations

import importlib.util
import os
import sys
import zipfile

import pytest

from dse.cache import CacheWarning
from dse.domain.system import Element, SystemStructure
from dse.errors import DseError
from dse.fmu.component_build import build
from dse.fmu.fusion.fuse import Wanted, fuse_all
from dse.fmu.toolchain.compiler import find_compiler
from dse.fmu.unpack import open_fmu


@pytest.fixture
def bare(monkeypatch, tmp_path):
    """A machine without a compiler."""
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    return monkeypatch


def test_the_compiler_named_by_cc_is_taken_with_its_options(monkeypatch):
    plain = find_compiler()
    if plain.command[0] == sys.executable:
        pytest.skip("there is no compiler on PATH that CC could name")
    monkeypatch.setenv("CC", f"{plain.command[0]} -DSOME_OPTION")
    named = find_compiler()
    assert named.command[-1] == "-DSOME_OPTION"
    assert named.identity == f"{plain.identity}; -DSOME_OPTION"
    assert plain.command[0] not in plain.identity


def test_a_cc_that_is_not_there_is_an_error_not_a_reason_to_take_another(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(DseError, match="CC is set to 'no-such-compiler', but it is not on PATH"):
        find_compiler()


def test_a_cc_that_is_no_compiler_is_an_error(monkeypatch):
    monkeypatch.setenv("CC", sys.executable)
    with pytest.raises(DseError, match="does not answer like gcc or clang"):
        find_compiler()


def test_a_machine_without_any_compiler_is_told_what_to_install(bare):
    bare.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(DseError, match=r"no C compiler on this machine\n.*pip install 'dse-workbench\[toolchain\]'"):
        find_compiler()


@pytest.fixture
def none(bare):
    """Takes the compilers away."""
    bare.undo()
    find = importlib.util.find_spec

    def take_away():
        bare.delenv("CC", raising=False)
        bare.setenv("PATH", "")
        bare.setattr(importlib.util, "find_spec", lambda name: None if name == "ziglang" else find(name))

    return take_away


def test_what_is_in_the_cache_needs_no_compiler(workshop, tmp_path, none, version):
    component = workshop.counter()
    archive = build(component, version=version, cache=tmp_path)
    own = open_fmu(archive, cache=tmp_path)
    foreign = tmp_path / "foreign.fmu"
    with zipfile.ZipFile(archive) as whole, zipfile.ZipFile(foreign, "w") as sources:
        for name in whole.namelist():
            if not name.startswith("binaries/"):
                sources.writestr(name, whole.read(name))
    if version == 3:
        compiled = open_fmu(foreign, cache=tmp_path)
    wanted = {
        "counter": Wanted(
            SystemStructure("counter", (Element("c", own, (), (own.variables["total"],), {}),), ()), ("c.total",)
        )
    }
    fused = fuse_all(wanted, cache=tmp_path)
    none()
    assert build(component, version=version, cache=tmp_path) == archive
    assert open_fmu(archive, cache=tmp_path) == own
    if version == 3:
        assert open_fmu(foreign, cache=tmp_path) == compiled
    assert fuse_all(wanted, cache=tmp_path) == fused
    for needed in (lambda: build(workshop.counter(0.5), version=version, cache=tmp_path), find_compiler):
        with pytest.raises(DseError, match=r"^there is no C compiler on this machine\n.*'dse-workbench\[toolchain\]'"):
            needed()


def test_what_any_compiler_made_is_found_without_one(workshop, tmp_path, none, monkeypatch):
    plain = find_compiler().command[0]
    components = {"-DONE": workshop.counter(), "-DOTHER": workshop.integrator()}
    built = []
    for option, component in components.items():
        monkeypatch.setenv("CC", f"{plain} {option}")
        built.append(build(component, cache=tmp_path))
    none()
    assert [build(component, cache=tmp_path) for component in components.values()] == built


def test_a_damaged_entry_cannot_be_made_again_without_a_compiler(workshop, tmp_path, none):
    os.truncate(build(workshop.counter(), cache=tmp_path), 100)
    none()
    with pytest.warns(CacheWarning, match="damaged"), pytest.raises(DseError, match="no C compiler on this machine"):
        build(workshop.counter(), cache=tmp_path)


@pytest.mark.thorough
@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")
def test_without_a_compiler_the_ziglang_wheel_builds(bare, workshop, cache):
    assert find_compiler().identity.startswith("ziglang ")
    model = open_fmu(build(workshop.counter(), cache=cache), cache=cache)
    from fmpy.fmi2 import FMU2Slave

    slave = FMU2Slave(unzipDirectory=str(model.folder), modelIdentifier=model.identifier, guid=model.token)
    slave.instantiate()
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, 0.05)
    assert slave.getInteger([model.variables["hits"].reference]) == [5]
    slave.freeInstance()


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")
@pytest.mark.thorough
def test_errors_of_the_ziglang_compiler_are_told_in_the_users_words_too(bare, workshop, cache):
    component = workshop.counter()
    code = component.source.files[0]
    text = code.read_text(encoding="utf-8")
    header = component.source.header
    header.write_text(header.read_text(encoding="utf-8").replace("int bias;", ""), encoding="utf-8")
    code.write_text(text.replace("c->par.bias", "0"), encoding="utf-8")
    with pytest.raises(DseError) as caught:
        build(component, cache=cache)
    assert [problem.what for problem in caught.value.problems] == [
        "struct counter has no member 'par.bias' for parameter 'bias'"
    ]
    code.write_text(text.replace("c->par.bias", "nowhere"), encoding="utf-8")
    header.write_text(header.read_text(encoding="utf-8").replace("double first;", "double first; int bias;"), "utf-8")
    with pytest.raises(DseError) as caught:
        build(component, cache=cache)
    assert str(caught.value.problems[0].where).startswith(f"{code}:")
