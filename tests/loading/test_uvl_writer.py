"""A design space written as UVL and read again is the same tree and means the same."""

from __future__ import annotations

from pathlib import Path

import pytest
from every_configuration import valid
from hypothesis import given, settings, strategies as st

import dse
from dse.api.lookup import space_of
from dse.domain.component import NO_INTERFACE, Component
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part, walk
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.loading.uvl.reading import read_uvl_text
from dse.loading.uvl.tokens import Source
from dse.loading.uvl.writing import to_uvl
from dse.loading.workspace import Workspace
from dse.loading.writing.design import write_design
from dse.units import parse_quantity

ROOT = Path(__file__).parents[2]


def read(text):
    return read_uvl_text(Source("model.uvl", text))


def count(space):
    return len(valid(space))


def shape(space):
    """The tree without its places in a file."""
    return [
        (
            path,
            type(node).__name__,
            getattr(node, "name", ""),
            {name: value.si for name, value in node.component.properties.items()} if isinstance(node, Part) else None,
        )
        for path, node in walk(space.root)
    ]


MODELS = {
    "groups": "features\n R {x 1}\n  or\n   A\n    alternative\n     A1 {x 2}\n     A2\n    alternative\n     A3\n     A4\n   B\n  optional\n   C\n  [1..2]\n   D\n   E {x 0.25}\n   F\n  [0..1]\n   G\n    [2..3]\n     G1\n     G2\n     G3\n   H\n",
    "constraints": "features\n R\n  optional\n   A {x 2}\n   B {x 3}\n    or\n     B1\n     B2\n   C {x -1}\nconstraints\n A => B | !C\n (A <=> B) | C\n A.x + B.x - 2 * C.x > 1.5\n sum(x) <= 4 & sum(x, B) >= 0\n floor(A.x / 2) != 7\n !(A & B & C)\n",
    "alternatives": "features\n R\n  alternative\n   A {x 2}\n    optional\n     A1 {x 3}\n   B {x 5}\n   C {x -1}\nconstraints\n A.x + B.x + C.x < 5\n sum(x, A) != 5\n",
    "averages": "features\n R\n  optional\n   A {x 2}\n   B {x 3}\n    or\n     B1 {x 9}\n     B2\n   C {x -1}\nconstraints\n A | avg(x, B) >= 4\n avg(x) < 4\n",
    "words": 'features\n "or"\n  optional\n   "features"\n   "sum" {avg 1}\n   "a b"\nconstraints\n "features" => "sum"\n sum(avg) < 2\n',
}  # fmt: skip


@pytest.mark.parametrize("text", MODELS.values(), ids=MODELS)
def test_a_model_written_and_read_is_the_same_tree_with_the_same_configurations(text):
    space = read(text)
    again = read(to_uvl(space))
    assert shape(again) == shape(space)
    assert valid(again) == valid(space)
    if "avg" not in text:  # An average is guarded every time it is written.
        assert to_uvl(again) == to_uvl(space)


def test_ranges_are_written_as_ranges():
    text = to_uvl(read(MODELS["groups"]))
    assert "constraints" not in text
    assert [line.strip() for line in text.splitlines() if line.strip().startswith(("[", "or"))] == [
        "or", "[1..2]", "[0..1]", "[2..3]"
    ]  # fmt: skip


def part(name, **properties):
    return Part(Component(name, NO_INTERFACE, properties={k: parse_quantity(v) for k, v in properties.items()}))


def car(*rules):
    constraints = tuple(Constraint(f"r{n}", parse_expression(rule)) for n, rule in enumerate(rules))
    hybrid = Compound("hybrid", {"engine": Alternative((part("small", mass="90 kg"), part("big", mass="140 kg"))), "motor": part("pmsm", mass="40 kg")})  # fmt: skip
    root = Compound(
        "car",
        {
            "sensor": Alternative((part("radar", cost="60 EUR", range="150 m"), part("lidar", cost="800 EUR", range="0.2 km"))),
            "camera": Optional(part("mono", cost="20 EUR")),
            "rear": Optional(Alternative((part("mono", cost="20 EUR"), part("stereo", cost="50 EUR")))),
            "engine": Alternative((part("otto", mass="120 kg"), hybrid)),
            "body": part("body", mass="700 kg"),
        },
    )  # fmt: skip
    return DesignSpace("car", root, constraints)


RULES = [
    "sum(cost) <= 120 EUR",
    "sensor is lidar implies camera is absent",
    "camera is present iff rear is present",
    "rear in [mono, absent] xor sensor is radar",
    "sensor.range >= 160 m",
    "rear.cost >= 30 EUR",
    "sensor is radar implies rear.cost < 30 EUR",
    "not (rear.cost < 30 EUR)",
    "sum(mass) between 850 kg and 920 kg",
    "sum(mass, engine) * 2 > 250 kg",
    "engine.engine is big implies camera is present",
    "at_least(2, camera is present, rear is present, sensor is lidar)",
    "at_most(1, camera is present, rear is present, sensor is lidar)",
    "exactly(1, camera is present, rear is present, sensor is lidar)",
    "mean(cost) <= 50 EUR",
    "rear.cost between camera.cost and 30 EUR",
    "mean(cost, rear) <= 30 EUR",
    "same_choice(camera, rear)",
    "not same_choice(camera, rear)",
    "same_choice(camera, rear) iff sensor is radar",
    "if sensor is radar then camera is present else rear is present",
    "(if sensor is lidar then 200 m else 0 m) <= 150 m",
    "-sum(cost) < -100 EUR",
    "true and not false",
    "sensor.range ^ 2 > 30000 m^2",
]


@pytest.mark.parametrize("rule", RULES)
def test_a_constraint_of_ours_leaves_as_many_configurations_in_uvl(rule):
    space = car(rule)
    assert 0 < count(read(to_uvl(space))) == count(space)


def test_the_names_of_places_that_stand_several_times_stay_apart():
    text = to_uvl(car())
    names = [node.name for path, node in walk(read(text).root) if isinstance(node, Part)]
    assert len(names) == len(set(names))
    assert "// cost is in SI base units (currency)" in text


REFUSED = {
    "max(cost) < 70 EUR": "UVL cannot express 'max'",
    "count(cost) < 3": "UVL cannot express 'count'",
    "sum(mass) ^ sum(mass) < 3 kg": "UVL cannot express this",
    "sqrt(sum(mass) / 1 kg) < 3": "UVL cannot express 'sqrt'",
    "camera is present iff rear.cost > 3 EUR": "a comparison that can be undefined",
    "sensor.kp.max > 3": "'sensor.kp.max', which is not a property",
    "(if camera is present then sum(cost) else 2 EUR) < 3 EUR": "UVL cannot express",
}


@pytest.mark.parametrize("rule", REFUSED)
def test_what_uvl_cannot_say_is_refused_by_name(rule):
    with pytest.raises(DseError) as caught:
        to_uvl(car("sum(cost) < 3 EUR", rule))
    (problem,) = caught.value.problems
    assert problem.what.startswith("constraint 'r1': ")
    assert REFUSED[rule] in problem.what


def test_numbers_that_never_end_in_si_are_written_in_their_own_unit():
    root = Compound("r", {"a": Optional(part("a", speed="1 km/h")), "b": Optional(part("b", speed="90 km/h"))})
    space = DesignSpace("r", root, (Constraint("slow", parse_expression("sum(speed) <= 1 km/h")),))
    text = to_uvl(space)
    assert "// speed is in km/h" in text
    assert "sum(speed) * 5 / 18 <=" in text
    assert count(read(text)) == count(space) == 2


def test_a_number_without_end_is_refused():
    root = Compound("r", {"a": part("a", angle="1 deg"), "b": part("b", angle="1 rad")})
    with pytest.raises(DseError, match="no finite decimals"):
        to_uvl(DesignSpace("r", root))


@st.composite
def spaces(draw):
    """A small space of nested containers."""
    names = iter(f"n{number}" for number in range(1000))

    def node(depth):
        kind = draw(st.sampled_from(["part", "part", "optional", "alternative", "compound"]))
        if kind == "part" or depth == 3:
            return part(draw(st.sampled_from(["a", "b", "c"])), x=str(draw(st.integers(-2, 5))))
        if kind == "optional":
            inner = node(depth + 1)
            return inner if isinstance(inner, Optional) else Optional(inner)
        if kind == "compound":
            return compound(next(names), depth + 1)
        options = [
            compound(next(names), depth + 1) if draw(st.booleans()) else part(next(names), x="2") for _ in range(2)
        ]
        return Alternative(tuple(options))

    def compound(name, depth):
        return Compound(
            name, {draw(st.sampled_from("pqrs")) + str(n): node(depth) for n in range(draw(st.integers(1, 3)))}
        )

    bound = draw(st.integers(-3, 12))
    return DesignSpace("space", compound("space", 0), (Constraint("bound", parse_expression(f"sum(x) <= {bound}")),))


@settings(max_examples=150, deadline=None)
@given(spaces())
def test_any_space_has_as_many_configurations_in_uvl(space):
    if any(isinstance(node, Part) and node.component.properties for _, node in walk(space.root)):
        assert count(read(to_uvl(space))) == count(space)


def test_the_example_design_can_be_written():
    space = Workspace(ROOT).design("acc_vehicle")
    assert count(read(to_uvl(space))) == count(space)


def test_a_root_without_children_keeps_its_name():
    space = read("features\n A {cost 1}\n")
    assert "\n    A {cost 1}\n" in to_uvl(space)


QUOTED = """\
features
    "My Car"
        mandatory
            "Front Radar" {Price 3}
                alternative
                    "Long Range"
                    "Short-Range"
            "in_"
        optional
            "a b"
                or
                    Inner
                    "Inner 2" {Price 2}
            "a-b"
            a_b_2
constraints
    "Long Range" => "a-b" & "a b"
    "Inner 2".Price < 3
"""


def test_quoted_names_come_back():
    space = read(QUOTED)
    text = to_uvl(space)
    names = {line.strip().partition(" {")[0] for line in QUOTED.splitlines()[1:16] if '"' in line}
    names -= {'"in_"'}  # needs none
    assert len(names) == 7
    assert all(f"{name}\n" in text.replace(" {Price 3}", "").replace(" {Price 2}", "") for name in names)
    assert to_uvl(read(text)) == text
    assert count(read(text)) == count(space)


def test_a_title_that_is_not_how_a_name_is_spelled_does_not_become_one():
    root = Compound("r", {"radar": Part(Component("radar", NO_INTERFACE, "Radar of 77 GHz"))}, title="Root of all")
    assert '"' not in to_uvl(DesignSpace("r", root))


def test_questions_take_titles_in_quotes(tmp_path):
    (tmp_path / "model.uvl").write_text(QUOTED, encoding="utf-8")
    space = space_of(str(tmp_path / "model.uvl"))
    design = dse.api.Design.of(space)
    assert design.count(where='"a-b" is present and "a b" is absent', exact=True) == design.count(
        where="a_b_3 is present and a_b is absent", exact=True
    )
    (best,) = design.best(maximize='if "a-b" is present then 1 else 0', n=1)
    assert best.values[0] == 1
    with pytest.raises(DseError, match=r"^--where:1:21: nothing is called 'a\+b'") as caught:
        design.count(where='"a b" is present or "a+b" is present')
    assert caught.value.problems[0].hint == "did you mean 'a-b'?"


def test_the_title_of_a_compound_is_read_and_written(tmp_path):
    for name in ("components", "designs"):
        (tmp_path / name).mkdir()
    (tmp_path / "components/parts.yaml").write_text("components: {radar: {}}\n", encoding="utf-8")
    text = (
        'design: car\nroot:\n  title: "Car, whole"\n  compound:\n'
        "    front: {title: Front end, compound: {radar: radar}}\n"
    )
    (tmp_path / "designs/car.yaml").write_text(text, encoding="utf-8")
    assert write_design(Workspace(tmp_path).design("car")) == text
    (tmp_path / "designs/car.yaml").write_text(text.replace("Front end", "3"), encoding="utf-8")
    with pytest.raises(DseError, match="'title': expected text"):
        Workspace(tmp_path).design("car")
