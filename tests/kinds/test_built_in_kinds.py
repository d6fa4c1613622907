"""Every kind that comes with dse does what a kind has to do."""

from __future__ import annotations

import os
import sys

import pytest
from kinds.examples import EXAMPLES, written
from sumo_here import IS_HERE

from dse.errors import DseError
from dse.fmu.component_build import build
from dse.loading.component.kind import KINDS, kind_of
from dse.testing.kinds import Files, KindSuite, lay_out, the_component

DEAR = {"road", "scenario", "sumo"}
"""Kinds whose FMUs take seconds to make."""


class TestBuiltInKinds(KindSuite):
    @pytest.fixture(
        params=[
            pytest.param(name, marks=pytest.mark.thorough if name in DEAR else ())
            for name in KINDS.names()
            if KINDS.package(name) == "dse"
        ]
    )
    def example(self, request: pytest.FixtureRequest) -> Files:
        if request.param == "sumo" and not (IS_HERE or os.environ.get("CI")):
            pytest.skip("SUMO is not installed")
        assert request.param in EXAMPLES, "write an example of the new kind into tests/kinds/examples.py"
        return EXAMPLES[request.param]()


@pytest.mark.parametrize(
    ("source", "place", "what", "hint"),
    [
        ("{file: x.fmu}", "3:1", "'kind' is missing in 'source'", "add 'kind: …'"),
        ("{kind: [c]}", "3:16", "'source.kind': expected text, found a list", "quote it if it is meant as text"),
        ("{kind: c, fils: [twice.c], files: [twice.c]}", "3:19", "unknown key 'fils'", "did you mean 'files'?"),
        ("{kind: c, files: 3}", "3:26", "'source.files': expected a list, found 3", "write it as [a, b]"),
        ("fmu", "3:9", "'source': expected a mapping, found 'fmu'", "write it as {key: value}"),
    ],
)
def test_what_is_wrong_in_a_source_is_told_where_it_stands(tmp_path, source, place, what, hint):
    files = {**EXAMPLES["c"](), **written(source)}
    with pytest.raises(DseError) as caught:
        the_component(lay_out(files, tmp_path))
    (problem,) = caught.value.problems
    assert (str(problem.where).partition("component.yaml:")[2], problem.what, problem.hint) == (place, what, hint)


def test_what_is_wrong_in_a_source_and_around_it_is_told_at_once(tmp_path):
    files = written("{kind: fmu, fil: x}")
    files["twice/component.yaml"] += "colour: red\n"
    with pytest.raises(DseError) as caught:
        the_component(lay_out(files, tmp_path))
    assert [problem.what for problem in caught.value.problems] == ["unknown key 'fil'", "unknown key 'colour'"]


def test_without_libclang_generated_code_is_not_looked_into_and_that_is_told(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "clang", None)
    component = the_component(lay_out(EXAMPLES["simulink"](), tmp_path))
    (told,) = kind_of(component).check(component, component.source)
    assert "libclang is not installed" in told.what
    with pytest.raises(DseError, match="libclang, which is not installed"):
        build(component, cache=tmp_path / "cache")
