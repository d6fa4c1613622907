"""A design space written as YAML and read again is the same but for where it stands."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from every_configuration import valid
from hypothesis import given, settings, strategies as st

from dse.domain.component import NO_INTERFACE, Component, CSource
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part, walk
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.expression.tree import same
from dse.kinds.fmu import FmuSource
from dse.loading.design.design import read_design
from dse.loading.uvl.reading import read_uvl_text
from dse.loading.uvl.tokens import Source
from dse.loading.workspace import Workspace
from dse.loading.writing.design import write_components, write_design
from dse.space.check import check_space
from dse.units import parse_quantity

ROOT = Path(__file__).parents[2]


def tree(space):
    nodes = []
    for path, node in walk(space.root):
        entry = [path, type(node).__name__, getattr(node, "name", ""), node.interface]
        if isinstance(node, Part):
            parameters = tuple(replace(parameter, where=None) for parameter in node.component.parameters)
            entry.append(replace(node.component, where=None, parameters=parameters))
        if isinstance(node, Compound):
            entry.append([str(connection) for connection in node.connections])
        nodes.append(entry)
    return nodes


def assert_same(space, other):
    assert (space.name, space.title) == (other.name, other.title)
    assert tree(space) == tree(other)
    assert [replace(one, where=None) for one in space.sets] == [replace(one, where=None) for one in other.sets]
    for mine, its in ((space.constraints, other.constraints), (space.all_constraints, other.all_constraints)):
        assert [(c.name, c.because, c.set) for c in mine] == [(c.name, c.because, c.set) for c in its]
        for a, b in zip(mine, its, strict=True):
            assert same(a.rule.root, b.rule.root), a.name


def written_and_read(space, folder):
    """In a workspace of *folder* that has the components of *space*."""
    (folder / "designs").mkdir(exist_ok=True)
    (folder / "components").mkdir(exist_ok=True)
    components = {node.component.name: node.component for _, node in walk(space.root) if isinstance(node, Part)}
    (folder / "components/all.yaml").write_text(write_components(components.values()), encoding="utf-8")
    (folder / f"designs/{space.name}.yaml").write_text(write_design(space), encoding="utf-8")
    return Workspace(folder).design(space.name)


def test_the_example_design_comes_back(tmp_path):
    workspace = Workspace(ROOT)
    space = workspace.design("acc_vehicle")
    path = tmp_path / "acc_vehicle.yaml"
    path.write_text(write_design(space), encoding="utf-8")
    assert_same(read_design(path, workspace.component, workspace.interfaces, workspace.stand_ins, tmp_path), space)


EVERYTHING = """\
design: everything
title: "Titles: with 'quotes', # and \\"more\\" \\u2028 ü"
constraint_sets:
  winter: {on: false, title: Only in winter}
  summer: {on: true}
root:
  compound:
    a: {alternatives: [x, y]}
    b: {optional: x}
    c: {optional: {alternatives: [x, y]}}
    d:
      alternatives:
        - x
        - wide:
            compound:
              e: {optional: {compound: {g: y, h: {optional: x}}, constraints: {deep: {require: h is present}}}}
              f: {alternatives: [x, y]}
            constraints:
              light: {require: sum(mass) <= 3 kg, because: "it: floats"}
              both: {forbid: [e is present, f is x]}
              counted: {at_least: {1: [e is present, f is y]}, set: winter}
              bare: {require: cost <= 9 EUR or e.g.cost > 1 EUR}
    null: y
constraints:
  budget: {require: sum(cost) <= 100 EUR, because: because, set: summer}
  alike: {same_choice: [a, b]}
  ranged: {range: {a.cost: [1 EUR, 90 EUR]}}
  chosen: {require: "if a is x then b is absent else c in [x, absent]"}
  with: {require_with: {if: a is x, then: [b is present, c is y]}}
  numbers: {require: sum(mass) * -2 + 1/3 * 7 kg between -20 kg and 1e3 kg}
  flag: {require: "true"}
"""


def test_every_construct_comes_back(tmp_path):
    (tmp_path / "components").mkdir()
    (tmp_path / "designs").mkdir()
    facts = "components:\n  x: {properties: {cost: 5 EUR, mass: 2 kg}}\n  y: {title: 'true', properties: {cost: 45 EUR, mass: 300 g}}\n"
    (tmp_path / "components/all.yaml").write_text(facts, encoding="utf-8")
    (tmp_path / "designs/everything.yaml").write_text(
        EVERYTHING.replace("1/3 * 7 kg", "1 / 3 * 7 kg"), encoding="utf-8"
    )
    space = Workspace(tmp_path).design("everything")
    assert [c.name for c in space.all_constraints if ": " in c.name] == [
        "d.wide: light", "d.wide: both", "d.wide: counted", "d.wide: bare", "d.wide.e: deep"
    ]  # fmt: skip
    again = written_and_read(space, tmp_path)
    assert_same(again, space)
    assert valid(again) == valid(space)
    assert write_design(again) == write_design(space)


def test_components_come_back_with_parameters_and_interfaces(tmp_path):
    (tmp_path / "components").mkdir()
    text = """\
interfaces:
  drive: {inputs: {demand: N.m}}
"""
    (tmp_path / "components/interfaces.yaml").write_text(text, encoding="utf-8")
    text = """\
components:
  a:
    title: "no: 1"
    implements: drive
    parameters:
      gain: {start: 0.1, min: -3, max: 1e9, unit: km/h, title: the gain}
      mode: {start: near, enum: [near, far]}
      number: {start: 3, type: int, tunable: false}
      flag: {start: true}
      temperature: {start: 21.3 °C}
    properties: {mass: 2.50 kg, plain: 0.70, whole: 3, small: .5, tiny: 1e-7, negative: -4}
  b: {}
"""
    (tmp_path / "components/some.yaml").write_text(text, encoding="utf-8")
    names = ("a", "b")
    first = [Workspace(tmp_path).component(name) for name in names]
    (tmp_path / "components/some.yaml").write_text(write_components(first), encoding="utf-8")
    again = [Workspace(tmp_path).component(name) for name in names]

    def bare(component):
        parameters = tuple(replace(parameter, where=None) for parameter in component.parameters)
        return replace(component, where=None, parameters=parameters)

    assert [bare(component) for component in again] == [bare(component) for component in first]


@pytest.mark.parametrize("source", [FmuSource(Path("x.fmu")), CSource((), Path("x.h"), "x", "x", "x", None)])
def test_a_component_with_a_source_is_refused(source):
    with pytest.raises(DseError, match="component 'x' has a source"):
        write_components([Component("x", NO_INTERFACE, source=source)])


def test_an_architecture_that_is_not_called_as_its_place_is_refused():
    inner = Compound("other", {"x": Part(Component("x", NO_INTERFACE))})
    with pytest.raises(DseError, match="'other' at 'place' is not called as its place"):
        write_design(DesignSpace("d", Compound("d", {"place": Optional(inner)})))


def test_a_feature_model_becomes_a_workspace(tmp_path):
    text = """\
namespace Kitchen
features
  Menu {Price 0.50, "old name" 3}
    mandatory
      Bread {Price 2.5}
    or
      Ham
        alternative
          Raw {Price 1}
          "well done" {Price -2}
        [1..2]
          is
          Null
          Two
      Egg
constraints
  Raw => Egg | !Two
  Raw.Price + "well done".Price < 0.3 | sum(Price) > 3
"""
    space = read_uvl_text(Source("menu.uvl", text))
    again = written_and_read(space, tmp_path)
    assert_same(again, space)
    assert check_space(again) == []
    assert valid(again) == valid(space)
    assert again.constraints[-2].because == "Raw => Egg | !Two"


texts = st.text(st.characters(codec="utf-8", exclude_categories=["Cc", "Cs"], exclude_characters="\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"), max_size=20)  # fmt: skip


@settings(max_examples=100, deadline=None)
@given(texts, texts, st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,5}", fullmatch=True).filter(lambda word: word not in ("is", "in", "or", "if")))  # fmt: skip
def test_any_words_come_back(tmp_path_factory, title, because, name):
    part = Part(Component("x", NO_INTERFACE, title, properties={"p": parse_quantity("1.50 kg")}))
    rule = Constraint("c", parse_expression("a is x"), because)
    space = DesignSpace("d", Compound("d", {"a": Alternative((part,)), "b": part}), (rule,), title)
    folder = tmp_path_factory.mktemp("w")
    assert_same(written_and_read(space, folder), space)
