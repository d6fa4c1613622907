"""A refined space has the configurations that choose nothing else, with their ids."""

from __future__ import annotations

from functools import lru_cache

import pytest
from every_configuration import valid
from hypothesis import given, settings, strategies as st

from dse.domain.component import NO_INTERFACE, Causality, Component, Interface, Kind, Port, Type
from dse.domain.design import Alternative, Compound, Connection, Constraint, DesignSpace, Optional, Part, walk
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.loading.workspace import Workspace
from dse.loading.writing.design import write_components, write_design
from dse.space.check import check_space
from dse.space.configurations.resolve import Resolver
from dse.space.decisions import decisions, flat
from dse.space.restriction.refine import refine, spanned
from dse.units import parse_quantity

SHAFT = Interface("shaft", (Port("out", Causality.OUTPUT, Type(Kind.REAL)),))
FEED = Interface("feed", (Port("into", Causality.INPUT, Type(Kind.REAL)),))


def part(name, interface=NO_INTERFACE, **properties):
    return Part(Component(name, interface, properties={k: parse_quantity(v) for k, v in properties.items()}))


def configurations(space):
    resolver = Resolver(space)
    return [resolver.configuration(choices) for choices in valid(space)]


def car(*rules):
    sizes = part("litre_40", FEED, mass="35 kg"), part("litre_60", FEED, mass="50 kg")
    motors = part("small", SHAFT, mass="40 kg"), part("big", SHAFT, mass="60 kg")
    hybrid = Compound(
        "hybrid",
        {"motor": Alternative(motors), "tank": Optional(Compound("tank", {"size": Alternative(sizes)}))},
        (Connection("motor.out", "tank.size.into"),),
    )
    parts = {
        "sensor": Alternative((part("radar", cost="60 EUR", reach="150"), part("lidar", cost="800 EUR", reach="1"))),
        "camera": Optional(part("mono", cost="20 EUR")),
        "rear": Optional(Alternative((part("mono", cost="20 EUR"), part("stereo", cost="50 EUR")))),
        "engine": Alternative((part("otto", mass="120 kg"), hybrid)),
        "light": Optional(part("led", power="3 W")),
        "body": part("body", mass="700 kg"),
    }  # fmt: skip
    constraints = tuple(Constraint(f"r{n}", parse_expression(rule)) for n, rule in enumerate(rules))
    return DesignSpace("car", Compound("car", parts), constraints)


def fits(tree, choices, subset):
    """Whether all decisions that are made are made as *subset* says."""
    for decision in tree:
        choice = choices.get(decision.path)
        if choice not in subset.get(decision.path, (choice,)):
            return False
        (branch,) = (branch for branch in decision.branches if branch.choice == choice)
        if not fits(branch.decisions, choices, subset):
            return False
    return True


@lru_cache(maxsize=64)
def everything(rules):
    return valid(car(*rules))


def assert_refined(rules, subset):
    space = car(*rules)
    tree = decisions(space)
    expected = [choices for choices in everything(rules) if fits(tree, choices, subset)]
    try:
        refined = refine(space, subset)
    except DseError:
        assert not expected
        return
    assert check_space(refined) == []
    # Ids depend on the choices alone.
    assert valid(refined) == expected


RULES = [
    "sensor is lidar implies camera is absent",
    "sensor in [lidar, radar]",
    "camera is present iff rear is present",
    "(rear in [mono, absent]) xor (light is present)",
    "sum(power) > 1 W",
    "power < 1 W",
    "count(power) == 0 and product(reach) < 100",
    "max(power) <= 2 W",
    "sum(mass, engine.tank) < 40 kg",
    "engine.tank.size.mass >= 50 kg",
    "not (rear.cost >= 30 EUR)",
    "rear.cost + camera.cost >= 50 EUR iff sensor is radar",
    "rear.cost > 30 EUR xor camera.cost > 30 EUR",
    "if rear.cost > 30 EUR then sensor is radar else camera is present",
    "not (if rear.cost > 30 EUR then sensor is radar else sensor is lidar)",
    "(if camera is present then rear.cost else 30 EUR) >= 30 EUR",
    "not ((if camera is present then rear.cost else 30 EUR) >= 30 EUR)",
    "(if rear.cost > 30 EUR then 1 else 2) < 2",
    "rear.cost between camera.cost and 45 EUR",
    "at_least(2, camera is present, rear is stereo, sensor is lidar)",
    "at_most(1, camera is present, rear.cost > 30 EUR, sensor is lidar)",
    "exactly(1, camera is present, rear.cost > 30 EUR, sensor is lidar)",
    "not exactly(1, camera is present, rear.cost > 30 EUR, light is led)",
    "same_choice(camera, rear)",
    "not same_choice(camera, rear)",
    "min(rear.cost, camera.cost) >= 20 EUR or light is present",
    "engine.motor is big and engine.tank is present implies engine.tank.size is litre_40",
    "abs(sum(cost, rear) - 30 EUR) < 25 EUR",
    "mean(cost, rear) <= 30 EUR",
]


def decision_table(space):
    return {d.path: sorted({b.choice for b in d.branches}, key=str) for d in flat(decisions(space))}


def subsets():
    """Any choices of any decisions; most decisions are left open."""
    entries = {
        path: st.none() | st.sets(st.sampled_from(choices), min_size=1)
        for path, choices in decision_table(car()).items()
    }
    return st.fixed_dictionaries(entries).map(lambda drawn: {path: made for path, made in drawn.items() if made})


@pytest.mark.sampled(3)
@settings(max_examples=5, deadline=None)
@pytest.mark.parametrize("rule", RULES)
@given(st.data())
def test_a_refined_space_has_the_configurations_that_fit(rule, data):
    assert_refined((rule,), data.draw(subsets()))


@settings(max_examples=60, deadline=None)
@given(st.lists(st.sampled_from(RULES), max_size=4), st.data())
def test_a_refined_space_has_the_configurations_that_fit_several_rules(rules, data):
    assert_refined(tuple(rules), data.draw(subsets()))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("rule", RULES)
def test_every_single_choice_can_be_taken_away(rule):
    for path, choices in decision_table(car()).items():
        for choice in choices:
            assert_refined((rule,), {path: [other for other in choices if other != choice]})
            assert_refined((rule,), {path: [choice]})


def test_constraints_that_mention_nothing_that_is_gone_stay_as_they_are():
    space = car("sum(cost) <= 900 EUR", "rear is mono implies sensor is radar", "light is led")
    refined = refine(space, {"rear": ["stereo", None]})
    assert refined.constraints == (space.constraints[0], space.constraints[2])
    refined = refine(space, {"light": [None]})
    assert [c.rule.text for c in refined.constraints] == [
        "sum(cost) <= 900 EUR",
        "rear is mono implies sensor is radar",
        "false",
    ]


def test_one_option_is_still_an_alternative_and_a_forced_part_the_only_option():
    refined = refine(car(), {"sensor": ["radar"], "camera": ["mono"], "rear": ["stereo"], "light": [None]})
    parts = refined.root.parts
    assert isinstance(parts["sensor"], Alternative)
    assert isinstance(parts["camera"], Alternative)
    assert isinstance(parts["rear"], Alternative)
    assert "light" not in parts


def test_a_part_that_takes_its_architecture_with_it_leaves_the_others():
    refined = refine(car(), {"engine.tank": ["tank"], "engine.tank.size": []})
    assert [option.name for option in refined.root.parts["engine"].options] == ["otto"]


def test_an_architecture_that_must_be_there_is_kept_by_a_constraint():
    refined = refine(car("light is led"), {"engine.tank": ["tank"]})
    kept = refined.constraints[-1]
    assert (kept.name, kept.rule.text) == ("keep_engine_tank", "(engine is hybrid) implies engine.tank is present")


def test_parts_connections_and_ids_stay():
    space, subset = car(RULES[0]), {"engine": ["hybrid"], "camera": [None]}
    tree = decisions(space)
    kept = [one for one in configurations(space) if fits(tree, one.choices, subset)]
    assert configurations(refine(space, subset)) == kept
    assert any(one.connections for one in kept)


def test_the_smallest_subset_spans_what_was_chosen():
    space = car()
    some = [c.choices for c in configurations(space) if c.choices["sensor"] == "radar" and "rear" not in c.choices][:3]
    subset = spanned(space, some)
    assert subset["sensor"] == {"radar"}
    assert subset["rear"] == {None}
    assert {c.id for c in configurations(refine(space, subset))} >= {
        c.id for c in configurations(space) if c.choices in some
    }


@pytest.mark.parametrize(
    ("subset", "what"),
    [
        ({"sensr": ["radar"]}, "there is no decision 'sensr' in 'car'"),
        ({"sensor": ["rader"]}, "'rader' cannot be chosen for 'sensor'"),
        ({"sensor": [None]}, "'sensor' cannot be left out"),
        ({"sensor": []}, "nothing is left of 'car'"),
    ],
)
def test_a_subset_that_makes_no_sense_is_refused(subset, what):
    with pytest.raises(DseError, match=what):
        refine(car(), subset)


INTERFACES = """\
interfaces:
  shaft: {outputs: {out: 1}}
  feed: {inputs: {into: 1}}
"""
SUBSETS = {
    "an architecture kept": {"engine": ["hybrid"], "engine.tank": ["tank"], "engine.motor": ["big"]},
    "an architecture taken": {"engine.tank": [None], "rear": ["stereo"]},
    "a part kept": {"camera": ["mono"], "light": [None]},
}


@pytest.mark.parametrize("subset", SUBSETS.values(), ids=SUBSETS)
def test_a_refined_space_is_written_as_a_file_with_the_same_configurations(subset, tmp_path):
    refined = refine(car(*RULES[:3]), subset)
    (tmp_path / "components").mkdir()
    (tmp_path / "designs").mkdir()
    components = [node.component for _, node in walk(refined.root) if isinstance(node, Part)]
    (tmp_path / "components/interfaces.yaml").write_text(INTERFACES, encoding="utf-8")
    (tmp_path / "components/all.yaml").write_text(write_components(components), encoding="utf-8")
    (tmp_path / "designs/car.yaml").write_text(write_design(refined), encoding="utf-8")
    again = Workspace(tmp_path).design("car")
    assert check_space(again) == []
    assert [c.id for c in configurations(again)] == [c.id for c in configurations(refined)]
