"""Which compiler is taken, and what is said when there is none."""

from __future__ import annotations

import importlib.util
import sys

import pytest

from dse.errors import DseError
from dse.fmu.building import build
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
