"""Counting and listing against a brute-force listing of small random spaces."""

from __future__ import annotations

from itertools import islice, product

import pytest
from hypothesis import given, settings, strategies as st

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.configurations.ids import Identifier, identify
from dse.space.configurations.resolve import resolve
from dse.space.decisions import combinations
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places
from dse.space.methods.engine import Engine
from dse.space.methods.tally import Tally
from dse.space.questions.explain import broken_by
from dse.space.questions.id_search import find
from dse.space.space import open_space
from dse.units import parse_quantity

ANY = Interface("any", ())
COSTS = {name: cost for cost, name in enumerate("abcdef", start=1)}


def part(name):
    properties = {"cost": parse_quantity(f"{COSTS.get(name, 7)}.5 EUR")}
    return Part(Component(name, ANY, properties=properties))


def space(parts, *rules):
    constraints = tuple(Constraint(f"c{i}", parse_expression(rule)) for i, rule in enumerate(rules))
    return DesignSpace("car", Compound("car", parts), constraints)


def violated(a_space, choices):
    return tuple(entry.constraint.name for entry in broken_by(a_space, choices))


def choices_of(a_space):
    return [dict(configuration.choices) for configuration in open_space(a_space).configurations()]


SENSOR = Alternative((part("a"), part("b"), part("c")))
ENGINE = Alternative((part("d"), part("e")))
HYBRID = Compound("hybrid", {"engine": ENGINE, "gearbox": part("f")}, (), ANY)
POWERTRAIN = Alternative((part("a"), HYBRID))


def test_an_optional_container_doubles_the_configurations():
    assert combinations(space({"s": SENSOR})) == 3
    assert combinations(space({"s": SENSOR, "o": Optional(part("a"))})) == 6


def test_the_order_is_that_of_the_file_with_the_last_part_fastest():
    listed = choices_of(space({"s": Optional(part("a")), "p": POWERTRAIN}))
    assert listed == [
        {"s": "a", "p": "a"},
        {"s": "a", "p": "hybrid", "p.engine": "d"},
        {"s": "a", "p": "hybrid", "p.engine": "e"},
        {"p": "a"},
        {"p": "hybrid", "p.engine": "d"},
        {"p": "hybrid", "p.engine": "e"},
    ]


def test_parts_that_are_no_decision_are_parts_but_no_choices():
    configuration = next(open_space(space({"s": part("b"), "p": Compound("p", {"x": part("c")})})).configurations())
    assert configuration.choices == {}
    assert {path: component.name for path, component in configuration.parts.items()} == {"s": "b", "p.x": "c"}
    assert configuration.total("cost") == 6.0


def test_a_space_of_one_design_has_one_configuration():
    assert (combinations(space({"s": part("a")})), open_space(space({"s": part("a")})).count()) == (1, Tally(1))


def test_the_total_of_a_huge_space_is_exact_and_its_first_design_comes_at_once():
    parts = {f"p{i}": SENSOR for i in range(60)}
    huge = space(parts, "p0 is not a")
    assert combinations(huge) == 3**60
    first = next(open_space(huge).configurations())
    assert first.choices["p0"] == "b"


def test_a_constraint_on_early_decisions_is_counted_without_visiting_the_rest():
    parts = {f"p{i}": SENSOR for i in range(60)}
    assert open_space(space(parts, "p0 is not a")).count() == Tally(2 * 3**59)


def test_a_sum_over_a_huge_space_is_counted_exactly():
    parts = {f"p{i}": SENSOR for i in range(60)}
    # a, b and c cost 1.5, 2.5 and 3.5 EUR; the sums are symmetric about 150 EUR, and (1 + x + x²)^60 has this middle.
    powers = [1]
    for _ in range(60):
        powers = [sum(powers[max(i - 2, 0) : i + 1]) for i in range(len(powers) + 2)]
    assert open_space(space(parts, "sum(cost) <= 150 EUR")).count() == Tally((3**60 + powers[60]) // 2)


def test_a_condition_that_is_undefined_selects_nothing():
    parts = {"s": Optional(SENSOR), "t": ENGINE}
    wanted = parse_expression("s.cost < 3 EUR")
    found = [dict(c.choices) for c in open_space(space(parts), where=wanted).configurations()]
    assert [c["s"] for c in found] == ["a", "a", "b", "b"]
    both = parse_expression("s.cost < 3 EUR and t is d or sum(cost) > 9 EUR")
    listed = {c.id for c in open_space(space(parts), where=both).configurations()}
    rule = compile_in(both, Places(space(parts)))
    assert listed == {c.id for c in open_space(space(parts)).configurations() if rule.outcome(c.choices)}


def test_a_partial_design_that_breaks_a_rule_is_not_continued():
    parts = {"s": SENSOR, **{f"p{i}": SENSOR for i in range(40)}}
    # 2·3^40 of 3^41 designs break the rule; visiting them would not end.
    listed = list(islice(open_space(space(parts, "s is c")).configurations(), 3))
    assert {configuration.choices["s"] for configuration in listed} == {"c"}


def test_an_id_survives_another_order_of_the_file():
    one = {c.id: c.choices for c in open_space(space({"s": SENSOR, "p": POWERTRAIN})).configurations()}
    shuffled = Alternative((Compound("hybrid", dict(reversed(HYBRID.parts.items())), (), ANY), part("a")))
    other = {
        c.id: c.choices
        for c in open_space(space({"p": shuffled, "s": Alternative(SENSOR.options[::-1])})).configurations()
    }
    assert one == other
    assert len(one) == combinations(space({"s": SENSOR, "p": POWERTRAIN})) == 9


def test_an_id_survives_new_alternatives_and_new_parts_that_are_left_out():
    before = {c.id: c.choices for c in open_space(space({"s": SENSOR, "p": POWERTRAIN})).configurations()}
    more = Alternative((part("f"), *SENSOR.options))
    grown = space({"new": Optional(part("a")), "s": more, "p": POWERTRAIN, "fixed": part("b")}, "sum(cost) < 99 EUR")
    after = {c.id: c.choices for c in open_space(grown).configurations()}
    assert before.items() <= after.items()
    assert len(after) == 2 * 4 * 3


def test_ids_of_a_block_are_those_of_its_configurations():
    twice = space({"p": POWERTRAIN, "ß": Optional(SENSOR), "a": ENGINE, "fixed": part("a")})
    engine = open_space(twice).engine
    ids = [name for rows in engine.blocks() for name in Identifier(engine.flat.variables).ids(rows)]
    listed = list(open_space(twice).configurations())
    assert ids == [identify(c.choices) for c in listed] == [c.id for c in listed]


def test_an_id_is_ten_letters_and_digits_and_never_changes():
    assert identify({"s": "a", "p": "b"}) == identify({"p": "b", "s": "a"}) == "3ayi67tfyr"


def test_a_configuration_is_found_by_its_id_or_its_beginning():
    a_space = space({"s": SENSOR})
    wanted = list(open_space(a_space).configurations())[1]
    assert open_space(a_space).configuration(wanted.id) == open_space(a_space).configuration(wanted.id[:8]) == wanted
    with pytest.raises(DseError, match="no valid configuration 'zzz'"):
        open_space(a_space).configuration("zzz")
    with pytest.raises(DseError, match="no valid configuration ''"):
        open_space(a_space).configuration("")


def test_a_search_for_an_id_ends_and_says_how_far_it_got():
    huge = space({f"p{i}": SENSOR for i in range(30)})
    first = next(open_space(huge).configurations())
    assert open_space(huge).configuration(first.id) == first
    with pytest.raises(DseError, match=r"among the first [\d,]+ of 'car'") as caught:
        find(huge, Engine.of(huge), "zzzzzzzzzz", most=1000)
    assert "--choose" in str(caught.value)
    with pytest.raises(DseError, match="may mean several"):
        find(huge, Engine.of(huge), first.id[:8], most=1000)


def test_choices_become_a_configuration_only_if_they_fit():
    a_space = space({"s": SENSOR, "p": POWERTRAIN, "o": Optional(part("a"))})
    listed = next(open_space(a_space).configurations())
    assert resolve(a_space, listed.choices) == listed
    with pytest.raises(DseError) as caught:
        resolve(a_space, {"s": "x", "p.engine": "d", "o": "a"})
    assert [problem.what for problem in caught.value.problems] == [
        "'s' cannot be 'x'",
        "nothing is chosen for 'p'",
        "there is no decision 'p.engine' in this design",
    ]


def test_two_architectures_may_use_the_same_place_for_different_decisions():
    inner = Compound("deep", {"k": Alternative((part("a"), part("b")))}, (), ANY)
    other = Compound("other", {"engine": Alternative((part("d"), inner)), "x": Optional(part("c"))}, (), ANY)
    twice = {"p": Alternative((HYBRID, other)), "s": SENSOR}
    assert combinations(space(twice)) == (2 + 3 * 2) * 3
    assert [c["p"] for c in choices_of(space(twice, "p.engine is d", "s is a"))] == ["hybrid", "other", "other"]
    # hybrid has a gearbox of 6.5 EUR: d = 4.5, e = 5.5, a = 1.5, b = 2.5, c = 3.5.
    cheap = choices_of(space(twice, "sum(cost, p) < 5 EUR", "s is a"))
    assert cheap == [
        {"p": "other", "p.engine": "d", "s": "a"},
        {"p": "other", "p.engine": "deep", "p.engine.k": "a", "s": "a"},
        {"p": "other", "p.engine": "deep", "p.engine.k": "b", "s": "a"},
    ]
    assert open_space(space(twice, "p.engine is deep implies p.x is c")).count() == Tally((2 + 2 + 2) * 3)


def test_the_constraints_a_design_breaks_are_named():
    a_space = space({"s": SENSOR}, "s is a", "cost <= 2 EUR", "s is not a")
    assert violated(a_space, {"s": "b"}) == ("c0", "c1")


def test_every_constraint_that_cannot_be_understood_is_reported_before_the_first_design():
    with pytest.raises(DseError) as caught:
        open_space(space({"s": SENSOR}, "t is a", "s is z")).configurations()
    assert len(caught.value.problems) == 2


# Random spaces: a tree is generated together with nothing else; the brute force below knows only the nouns.

leaves = st.sampled_from("abcdef").map(part)
options = st.lists(st.sampled_from("abcd"), min_size=1, max_size=3, unique=True).map(lambda names: [*map(part, names)])


def containers(inner):
    compounds = st.dictionaries(st.sampled_from("xyz"), inner, min_size=1, max_size=3)
    named = compounds.map(lambda parts: Compound("box", parts, (), ANY))
    alternatives = st.tuples(options, st.none() | named).map(lambda t: Alternative((*t[0], *([t[1]] if t[1] else []))))
    optionals = st.one_of(leaves, named, alternatives).map(Optional)
    return st.one_of(named, alternatives, optionals)


nodes = st.recursive(leaves, containers, max_leaves=5)
designs = st.dictionaries(st.sampled_from("uvw"), nodes, min_size=1, max_size=3)


def brute(node, path):
    """Every (choices, names by path) of *node*, by the definition of the containers."""
    match node:
        case Part():
            return [({}, {path: node.name})]
        case Compound():
            own = {path: node.name} if path else {}
            each = [brute(child, f"{path}.{name}" if path else name) for name, child in node.parts.items()]
            return [(merge(c for c, _ in combo), merge([own, *(n for _, n in combo)])) for combo in product(*each)]
        case Alternative():
            return [({path: o.name, **c}, names) for o in node.options for c, names in brute(o, path)]
        case Optional(Alternative() as content):
            return [*brute(content, path), ({}, {})]
        case Optional(content):
            return [*(({path: content.name, **c}, names) for c, names in brute(content, path)), ({}, {})]


def merge(mappings):
    return {key: value for mapping in mappings for key, value in mapping.items()}


def cost(names, below=""):
    inside = [n for path, n in names.items() if path == below or path.startswith(below + ".") or not below]
    return sum(COSTS[name] + 0.5 for name in inside if name in COSTS)


def rules_for(design):
    """Texts of rules on this design, each with what it means for the names by path."""
    first = next(iter(design))
    found = [
        ("sum(cost) <= 12 EUR", lambda names: cost(names) <= 12),
        (f"sum(cost, {first}) > 2 EUR", lambda names: cost(names, first) > 2),
        ("count(cost) == 3", lambda names: sum(name in COSTS for name in names.values()) == 3),
        (f"{first} is absent or cost < 9 EUR", lambda names: first not in names or cost(names) < 9),
    ]
    reachable = brute(Compound("", design), "")
    for path, name in sorted({item for _, names in reachable for item in names.items()})[:6]:
        found.append((f"{path} is {name}", lambda names, path=path, name=name: names.get(path) == name))
        found.append(
            (
                f"{path} is {name} implies sum(cost) < 8 EUR",
                lambda names, path=path, name=name: names.get(path) != name or cost(names) < 8,
            )
        )
    return found


@settings(max_examples=60, deadline=None)
@given(designs, st.data())
def test_listing_and_counting_agree_with_brute_force(design, data):
    everything = brute(Compound("", design), "")
    assert combinations(space(design)) == len(everything) == len(choices_of(space(design)))
    has_costs = any(name in COSTS for _, names in everything for name in names.values())
    known = rules_for(design) if has_costs else []
    first = next(iter(design))
    below = any(
        n in COSTS for _, names in everything for p, n in names.items() if p == first or p.startswith(f"{first}.")
    )
    known = [rule for rule in known if below or not rule[0].startswith(f"sum(cost, {first})")]
    chosen = data.draw(st.lists(st.sampled_from(known), max_size=3)) if known else []
    constrained = space(design, *(text for text, _ in chosen))
    expected = [choices for choices, names in everything if all(holds(names) for _, holds in chosen)]
    assert choices_of(constrained) == expected
    assert open_space(constrained).count() == Tally(len(expected))
    for choices in expected:
        assert violated(constrained, choices) == ()


@settings(max_examples=50, deadline=None)
@given(designs, st.data())
def test_a_constraint_never_adds_a_configuration_and_ids_are_unique(design, data):
    free = [configuration.id for configuration in open_space(space(design)).configurations()]
    text, _ = data.draw(st.sampled_from([rule for rule in rules_for(design) if "sum(cost, " not in rule[0]]))
    bound = [configuration.id for configuration in open_space(space(design, text)).configurations()]
    assert set(bound) <= set(free)
    assert len(set(free)) == len(free)
