"""Repeated places, chosen connections and allocations: counts against closed forms and against enumeration."""

from __future__ import annotations

import shutil
from contextlib import suppress
from dataclasses import replace
from math import comb, factorial, perm
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from structured_spaces import COMPONENTS, structured

import dse
from dse.domain.component import NO_INTERFACE, Component
from dse.domain.definition import DefinedAllocation, DefinedLoad
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.formats import dump_yaml
from dse.loading import Workspace, read_document, write_design
from dse.space import alternatives, open_space
from dse.space.check import check_space
from dse.space.methods.engine import Engine
from dse.testbench.definition import describe_configuration

OPTIONS = "alternatives: [A, B, C]"
ARCHITECTURE = "compound: {x: {alternatives: [A, B]}, y: {optional: {alternatives: [A, B]}}}"
"""Six ways."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    root = tmp_path_factory.mktemp("structure")
    (root / "designs").mkdir()
    (root / "components").mkdir()
    (root / "components/parts.yaml").write_text(COMPONENTS, encoding="utf-8")
    return root


def read(folder: Path, text: str) -> DesignSpace:
    (folder / "designs/tried.yaml").write_text(text, encoding="utf-8")
    return Workspace(folder).design("tried")


def space_of(folder: Path, *parts: str, rules: str = "") -> DesignSpace:
    lines = "".join(f"    {part}\n" for part in parts)
    return read(folder, f"design: tried\nroot:\n  compound:\n{lines}{f'constraints: {rules}' if rules else ''}\n")


def count(space: DesignSpace) -> int:
    assert check_space(space) == []
    return open_space(space).count(exact=True).value


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        (f"{{times: 0..4, {OPTIONS}}}", sum(3**k for k in range(5))),
        (f"{{times: 3, {OPTIONS}}}", 27),
        (f"{{times: 0..4, unordered: true, {OPTIONS}}}", sum(comb(2 + k, k) for k in range(5))),
        (f"{{times: 0..4, all_different: true, {OPTIONS}}}", sum(perm(3, k) for k in range(5))),
        (f"{{times: 1..3, all_different: true, unordered: true, {OPTIONS}}}", 3 + 3 + 1),
        ("{times: 2..5, of: A}", 4),
        (f"{{times: 0..3, {ARCHITECTURE}}}", sum(6**k for k in range(4))),
        (f"{{times: 0..3, unordered: true, {ARCHITECTURE}}}", sum(comb(5 + k, k) for k in range(4))),
        (f"{{times: 0..3, all_different: true, {ARCHITECTURE}}}", sum(perm(6, k) for k in range(4))),
        (f"{{optional: {{times: 1..2, {OPTIONS}}}}}", 1 + 3 + 9),
        (f"{{times: 2, compound: {{w: {{times: 0..2, unordered: true, {OPTIONS}}}}}}}", (1 + 3 + 6) ** 2),
    ],
)
def test_instances_are_sequences_multisets_or_sets(folder, part, expected):
    assert count(space_of(folder, f"p: {part}")) == expected


BELL_8, STIRLING_9_4 = 4140, 7770
"""Partitions of 8 into any number of blocks and of 9 into 4 (OEIS A000110, A008277)."""


@pytest.mark.parametrize(
    ("sources", "targets", "keys", "expected"),
    [
        (3, 4, "", 2**12),
        (3, 4, "incoming: 1..*", (2**3 - 1) ** 4),
        (8, 8, "outgoing: 1, unordered: true", BELL_8),
        (9, 4, "outgoing: 1, incoming: 1..*, unordered: true", STIRLING_9_4),
        (9, 4, "outgoing: 1, incoming: 1..*", STIRLING_9_4 * factorial(4)),
        (10, 10, "outgoing: 1, incoming: 1", factorial(10)),
        (3, 5, "outgoing: 1, incoming: 0..1", perm(5, 3)),
        (3, 5, "outgoing: 0..1, incoming: 0..1", sum(comb(3, k) * perm(5, k) for k in range(4))),
        (3, 4, "incoming: 1", 3**4),
        (10, 1, "outgoing: 0..1", 2**10),
        (10, 1, "outgoing: 0..1, total: 4..6", sum(comb(10, k) for k in (4, 5, 6))),
        (4, 3, "unordered: true", comb(2**4 + 2, 3)),
        (3, 3, "outgoing: 1..*, incoming: 1..*", 265),
        (3, 2, "exclude: [s.n1 -> t.n1, s.n3 -> t]", 2**3),
        (2, 2, "parallel: 3", 4**4),
        (1, 2, "parallel: 3, total: 4", 3),
    ],
)
def test_connections_are_counted_as_the_patterns_of_the_literature(folder, sources, targets, keys, expected):
    # Assigning, covering, partitioning, permuting and downselecting (Selva, Cameron and Crawley 2016, Patterns in
    # system architecture decisions); 265 are the 3 by 3 matrices of bits without an empty row or column (A048291).
    link = f"link: {{connect: s -> t{', ' * bool(keys)}{keys}}}"
    assert (
        count(space_of(folder, f"s: {{times: {sources}, of: A}}", f"t: {{times: {targets}, of: B}}", link)) == expected
    )


@pytest.mark.parametrize(
    ("keys", "expected"),
    [(", undirected: true", 2**10), ("", 2**20), (", undirected: true, outgoing: 2", 12), (", outgoing: 1", 4**5)],
)
def test_connecting_makes_graphs(folder, keys, expected):
    # 12 are the cycles through 5 nodes, 4!/2, the only graphs of 5 nodes of degree 2.
    assert count(space_of(folder, "s: {times: 5, of: A}", f"link: {{connect: s -> s{keys}}}")) == expected


def test_the_published_gnc_problem_has_its_published_numbers(folder):
    # Apaza and Selva (2021), as in adsg-core and SBArchOpt: 29,857 without actuators, 79,091,323 with them.
    kinds = [f"{name}: {{times: 1..3, unordered: true, {OPTIONS}}}" for name in ("sensor", "computer", "actuator")]
    links = [
        f"{a}_{b}: {{connect: {a} -> {b}, outgoing: 1..*, incoming: 1..*}}"
        for a, b in (("sensor", "computer"), ("computer", "actuator"))
    ]
    assert count(space_of(folder, *kinds[:2], links[0])) == 29_857
    assert count(space_of(folder, *kinds, *links)) == 79_091_323


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ("allocate: [f, g, h]", 27),
        ("allocate: [f, g, h], redundancy: {f: 2}", 27),
        ("allocate: [f, g, h], redundancy: 2", 27),
        ("allocate: [f, g, h], apart: [[f, g]]", 18),
        ("allocate: [f, g, h], apart: [[f, g, h]]", 6),
        ("allocate: [f, g, h], together: [[f, g]], apart: [[g, h]]", 6),
        ("allocate: [f, g, h], incoming: 0..1", 6),
        ("allocate: {f: {mass: 1 kg}, g: {mass: 1 kg}}, load: mass", 6),
        ("allocate: [f, s], exclude: [f -> t.n1]", 6),
        ("allocate: [f, s], load: [], together: [[f, s]]", 3),
    ],
)
def test_functions_are_allocated(folder, keys, expected):
    # Each of the three hosts states 1 kg.
    parts = ("s: A", "t: {times: 3, of: A}", f"placement: {{{keys}, to: t}}")
    assert count(space_of(folder, *parts)) == expected


def test_the_load_of_a_part_depends_on_what_was_chosen(folder):
    # A, B and C have 1, 2 and 4 kg; the function fits where the host has no less.
    parts = (
        "f: {alternatives: [A, B, C]}",
        "t: {times: 1, alternatives: [A, B, C]}",
        "m: {allocate: [f], to: t, load: mass}",
    )
    assert count(space_of(folder, *parts)) == 3 + 2 + 1


@pytest.mark.parametrize(
    "examples",
    [20, pytest.param(100, marks=pytest.mark.thorough), pytest.param(2000, marks=pytest.mark.nightly)],
)
def test_random_structures_have_as_many_configurations_as_there_are(folder, examples):
    @settings(max_examples=examples, deadline=None, database=None, suppress_health_check=[HealthCheck.too_slow])
    @given(random=st.randoms(use_true_random=False))
    def check(random) -> None:
        made = structured(random)
        if made.count == 0:
            with suppress(DseError):  # a degree that no choice can reach
                assert count(read(folder, dump_yaml(made.data))) == 0
            return
        space = read(folder, dump_yaml(made.data))
        assert count(space) == made.count
        if made.count < 300:
            found = [each.id for each in open_space(space).configurations()]
            assert len(set(found)) == len(found) == made.count
        assert count(read(folder, write_design(space))) == made.count
        assert read_document(folder / "designs/tried.yaml", folder).data == made.data
        # What is chosen of what can be: a refined design, written and read, has what the narrowed one has.
        path, names = random.choice([*alternatives(space).items()] or [("", (None,))])
        keep = f"{path}={random.choice(names) or 'absent'}"
        narrowed = open_space(space).part([keep]) if path else None
        if narrowed and not narrowed.is_empty():
            refined = read(folder, write_design(open_space(space).refined([keep])))
            assert count(refined) == narrowed.count(exact=True).value

    check()


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        # p is A, B or C, q is B, C or D, r is A or absent, s and t are B and C.
        ("ordered(p, q)", 8 * 2),
        ("ordered(q, p)", 6 * 2),  # in the order of the first place: B, C, D, then A
        ("ordered(r, r)", 18),
        ("ordered(q, r)", 18),
        ("all_different(p, q)", 14),
        ("all_different(p, r)", 3 * (2 + 3)),
        ("all_different(p, s)", 12),
        ("all_different(s, t)", 18),
        ("all_different(s, s)", 0),
    ],
)
def test_places_are_compared_by_their_names(folder, rule, expected):
    places = (f"p: {{{OPTIONS}}}", "q: {alternatives: [B, C, D]}", "r: {optional: A}", "s: B", "t: C")
    assert count(space_of(folder, *places, rules=f"{{c: {{require: '{rule}'}}}}")) == expected


def test_zero_needs_no_unit(folder):
    place = f"p: {{times: 2, {OPTIONS}}}"
    assert (
        count(space_of(folder, place, rules="{c: {require: 0 < sum(p.mass)}, d: {require: sum(p.mass) - 0 != 0}}")) == 9
    )
    (problem,) = check_space(space_of(folder, place, rules="{c: {require: sum(p.mass) > 1}}"))
    assert "cannot compare mass and a plain number" in problem.what
    (problem,) = check_space(space_of(folder, place, rules="{c: {require: 0 == (p.n1 is A)}}"))
    assert "cannot compare" in problem.what


def test_the_words_are_the_same_from_python():
    made = dse.Workspace.new()
    parts = {
        "sensor": {"times": "1..2", "unordered": True, "alternatives": ["radar_77ghz_mid", "lidar_905nm"]},
        "computer": {"times": 2, "of": "computer_small"},
        "feeds": {"connect": "sensor -> computer", "outgoing": "1..*"},
    }
    rule = {"require": "count(sensor is lidar_905nm) <= 1"}
    design = dse.Design("sensing", root={"compound": parts}, constraints={"lidars": rule}, workspace=made)
    # One sensor of two kinds with three ways to be connected; two radars, or one of each, with three ways each.
    assert design.count(exact=True) == 2 * 3 + 2 * 9
    assert len(design.list(where="each(sensor is lidar_905nm)")) == 3
    assert dse.Design.of(design.refine({}).space).count(exact=True) == 24
    parts["feeds"]["incoming"] = 3
    with pytest.raises(DseError, match=r"'computer\.n1' cannot have 3 connections") as caught:
        dse.Design("sensing", root={"compound": parts}, workspace=made)
    assert "incoming" in str(caught.value.problems[0].where)


WIRED = """\
design: tried
root:
  compound:
    radar: {times: 1..2, of: radar}
    camera: {optional: radar}
    fusion: {times: 1..2, of: fusion}
    world: world
    feeds: {connect: "radar.target, camera.target -> fusion.target_#", outgoing: 1..*, incoming: 1}
  connections: [world.gap -> radar.gap, world.gap -> camera.gap]
"""


@pytest.fixture(scope="module")
def wired(tmp_path_factory) -> DesignSpace:
    root = tmp_path_factory.mktemp("wired")
    (root / "designs").mkdir()
    (root / "components").mkdir()
    (root / "components/interfaces.yaml").write_text(
        "interfaces:\n  sensing: {inputs: {gap: m}, outputs: {target: m}}\n  giving: {outputs: {gap: m}}\n"
        "  fusing: {inputs: {target_1: m, target_2: m, target_3: m}, outputs: {nearest: m}}\n",
        encoding="utf-8",
    )
    (root / "components/parts.yaml").write_text(
        "components:\n  radar: {implements: sensing}\n  world: {implements: giving}\n  fusion: {implements: fusing}\n",
        encoding="utf-8",
    )
    return read(root, WIRED)


def test_chosen_connections_are_wires_of_the_configuration(wired):
    assert check_space(wired) == []
    # Every fusion has one source and every source feeds one: a radar alone one or two, two sources one each.
    found = {each.id: each for each in open_space(wired).configurations()}
    assert len(found) == 2 + 2 + 2
    for each in found.values():
        wires = {str(wire) for wire in each.connections}
        chosen = {path.rpartition(".")[2]: name for path, name in each.choices.items() if path.startswith("feeds.")}
        numbers = {"radar_1": ("radar.n1", 1), "radar_2": ("radar.n2", 2), "camera": ("camera", 3)}
        expected = {f"world.gap -> {path}.gap" for path, number in numbers.values() if path in each.parts}
        for fusion, source in chosen.items():
            path, number = numbers[source]
            expected.add(f"{path}.target -> fusion.n{fusion[-1]}.target_{number}")
        assert wires == expected


def test_wires_come_back_from_a_written_design(wired, tmp_path):
    text = write_design(wired)
    assert 'connect: "radar.target, camera.target -> fusion.target_#"' in text
    assert "  connections:\n    - world.gap -> radar.gap\n    - world.gap -> camera.gap\n" in text
    # Without the camera, they are written one by one.
    text = write_design(open_space(wired).refined(["camera=absent"]))
    assert "radar.n1.target -> fusion.n2.target_1 if feeds.fusion_2 is radar_1" in text


def test_rules_over_instances_of_which_none_is_left_hold(folder):
    rules = "{same: {same_choice: [p]}, apart: {all_different: [p]}, all: {require: each(p is A)}}"
    space = space_of(folder, "p: {times: 0..1, alternatives: [A, B]}", rules=rules)
    assert count(read(folder, write_design(open_space(space).refined(["p.n1=absent"])))) == 1


FORMS = """\
design: tried
title: All forms
constraint_sets: {light: {on: false, title: Light ones}}
root:
  compound:
    p: {times: 0..3, unordered: true, alternatives: [A, B, C]}
    q: {times: 2, of: A}
    r:
      times: 1..2
      compound: {x: {alternatives: [A, B]}, y: {optional: {alternatives: [A, B]}}}
      constraints: {one: {require: x is A or y is absent, because: of the room}}
    t: {connect: q -> p, outgoing: 1..*, incoming: 0..1, total: 1..4, exclude: [q.n1 -> p.n2], parallel: 2}
    u: {allocate: {f: {mass: 1 kg}, g: {mass: 100 g}}, to: "p,q", load: mass, apart: [[f, g]], redundancy: {f: 2}}
    v: {optional: {alternatives: [A, B, two: {compound: {a: {alternatives: [A, B]}, b: A}}]}}
constraints:
  a: {forbid: [p.n1 is B, "q.n1 is A"], because: "of a, b and c"}
  b: {require_with: {if: [v is A, p.n1 is present], then: r.n1.x is B}, set: light}
  c: {all_different: [p]}
  d: {exactly: {"2": [p.n1 is A, p.n2 is A, r.n1.x is A]}}
  e: {range: {q.mass: [1, 4 kg]}}
  f: {require: each(p.mass <= 20 kg) and count(p is A) < 4 and sum(p.mass) < 1 t}
"""


def test_a_design_is_written_in_the_forms_of_its_file(folder):
    text = FORMS.replace("q.mass: [1, 4 kg]", "q.n1.mass: [0 kg, 40 kg]")
    space = read(folder, text)
    asked = read_document(folder / "designs/tried.yaml", folder).data
    written = write_design(space)
    again = read(folder, written)
    assert read_document(folder / "designs/tried.yaml", folder).data == asked
    assert again.constraints == tuple(
        replace(one, where=again.constraints[at].where) for at, one in enumerate(again.constraints)
    )
    assert write_design(again) == written
    assert count(again) == count(space)


def test_what_was_changed_is_written_out(folder):
    space = read(folder, FORMS.replace("q.mass: [1, 4 kg]", "q.n1.mass: [0 kg, 40 kg]"))
    refined = write_design(open_space(space).refined(["r.n1.x=A"]))
    assert "p: {times: 0..3, unordered: true, alternatives: [A, B, C]}" in refined
    assert "times: 1..2" not in refined
    assert "        n1:\n" in refined
    narrowed = open_space(space).part(["r.n1.x=A"]).count(exact=True).value
    assert count(read(folder, refined)) == narrowed


def different(number: int, names: int, rule: str) -> DesignSpace:
    """Places with components of the same names, each pair under the *rule* as a constraint of its own."""
    choice = Alternative(tuple(Part(Component(f"t{name}", NO_INTERFACE)) for name in range(names)))
    pairs = [(f"p{a}", f"p{b}") for b in range(number) for a in range(b)]
    texts = [rule.format(p=p, q=q, v=f"t{v}") for p, q in pairs for v in (range(names) if "{v}" in rule else (0,))]
    rules = tuple(Constraint(f"c{n}", parse_expression(text)) for n, text in enumerate(texts))
    return DesignSpace("places", Compound("places", {f"p{n}": choice for n in range(number)}), rules)


@pytest.mark.parametrize("rule", ["not same_choice({p}, {q})", "not ({p} is {v} and {q} is {v})"])
def test_places_that_differ_pair_by_pair_are_recognised(rule):
    # Twelve by tables alone are too wide for any diagram; the same by sums are quick.
    space = different(12 if "same" in rule else 7, 12 if "same" in rule else 8, rule)
    engine = Engine.of(space)
    assert count(space) == (factorial(12) if "same" in rule else perm(8, 7))
    assert engine.expanded is not None
    # Each pair is still a constraint of its own: without one of them there are more.
    if "{v}" not in rule:
        return
    assert engine.only(range(1, len(space.constraints))).count(0).value == perm(8, 7) + perm(7, 5)


def test_a_table_that_says_more_than_different_names_stays():
    space = different(7, 8, "not ({p} is t0 and {q} is t0) and not ({p} is t1 and {q} is t2)")
    assert count(space) == brute(7, 8)


def brute(number: int, names: int) -> int:
    """Sequences with t0 at most once and no t1 before a t2."""
    ways = {(False, False): 1}
    for _ in range(number):
        after: dict[tuple[bool, bool], int] = {}
        for (zero, one), times in ways.items():
            for name in range(names):
                if (name == 0 and zero) or (name == 2 and one):
                    continue
                state = zero or name == 0, one or name == 1
                after[state] = after.get(state, 0) + times
        ways = after
    return sum(ways.values())


def test_the_rocket_of_sbarchopt_has_its_number(folder):
    # One to three stages, each with one to three engines of one of six types, and one of three heads (RocketArch).
    engines = "compound: {engine: {times: 1..3, alternatives: [A, B, C, D, E, F]}}"
    stage = f"{{times: 1..3, {engines}, constraints: {{alike: {{require: same_choice(engine)}}}}}}"
    assert count(space_of(folder, f"stage: {stage}", f"head: {{{OPTIONS}}}")) == 18_522


SENSING = """\
class Radar:
    def __init__(self, parameters):
        self.offset = parameters["offset"]

    def step(self, inputs, h):
        return {"target": inputs["gap"] + self.offset}
"""
FUSING = """\
class Fusion:
    def __init__(self, parameters):
        pass

    def step(self, inputs, h):
        return {"nearest": sum(inputs.values())}
"""
GIVING = """\
class World:
    def __init__(self, parameters):
        pass

    def step(self, inputs, h):
        return {"gap": 10.0}
"""
BENCH = """\
testbench: still
design: tried
test_components: {source: {component: world}}
connections: [source.gap -> radar.gap, source.gap -> camera.gap]
parameters: {radar.offset: 1 m, camera.offset: 5 m, fusion.target_1: 0 m, fusion.target_2: 0 m, fusion.target_3: 0 m}
simulation: {stop: 1 s, step: 100 ms}
metrics: {first: final(fusion.n1.nearest)}
"""


@pytest.mark.thorough
def test_instances_and_chosen_connections_are_simulated(wired, tmp_path):
    root = Path(shutil.copytree(Path(wired.where.file).resolve().parents[1], tmp_path / "still"))
    (root / "components/parts.yaml").unlink()
    for name, interface, text in (
        ("radar", "sensing", SENSING),
        ("fusion", "fusing", FUSING),
        ("world", "giving", GIVING),
    ):
        place = root / "components" / name
        place.mkdir()
        (place / f"{name}.py").write_text(text, encoding="utf-8")
        offset = "\nparameters: {offset: {start: 0 m}}" if name == "radar" else ""
        source = f"component: {name}\nimplements: {interface}\nsource: {{kind: python, files: [{name}.py]}}{offset}\n"
        (place / "component.yaml").write_text(source, encoding="utf-8")
    without = WIRED.replace("    world: world\n", "").partition("  connections")[0]
    (root / "designs/tried.yaml").write_text(without.replace("incoming: 1", "incoming: 1..2"), encoding="utf-8")
    (root / "testbenches").mkdir()
    (root / "testbenches/still.yaml").write_text(BENCH, encoding="utf-8")
    bench = dse.open(root).benches["still"]
    given = {"radar_1": 11.0, "radar_2": 11.0, "camera": 15.0}
    found = list(bench.design)
    assert len(found) > 6
    for each in found[:: len(found) // 3]:
        sources = {
            path.split(".")[1] for path in each.choices if path.startswith("feeds.") and path.endswith("fusion_1")
        }
        assert bench.simulate(each.id).metrics["first"] == pytest.approx(sum(given[one] for one in sources), abs=1e-12)


@pytest.mark.parametrize(
    ("parts", "marked", "hint"),
    [
        (["p: {times: §4..1, of: A}"], "the range 4..1 is empty", "smaller number first"),
        (["p: {times: §1..*, of: A}"], "'1..*' is not a number or a range of numbers", "2 or 1..3"),
        (["p: {times: §0, of: A}"], "0 instances", "1 to 1,000"),
        (["§p: {times: 2}"], "'p' needs one part that is repeated", "of: radar"),
        (["p: {times: 2, of: §Q}"], "unknown component 'Q'", ""),
        (["p: {times: 2, of: A, unordered: §2}"], "'unordered': expected true or false", ""),
        (["p: {times: 2, of: A, §ordered: true}"], "unknown key 'ordered'", ""),
        (["p: {times: 2, of: A}", "c: {connect: §p -> q}"], "unknown part 'q'", "p"),
        (["p: {times: 2, of: A}", "c: {connect: §p}"], "'p' has no arrow", "radar -> ecu"),
        (["p: {times: 2, of: A}", "c: {connect: p -> p, outgoing: §3}"], "'p.n1' cannot have 3 connections", "too few"),
        (["p: {times: 2, of: A}", "c: {connect: §p.x -> p}"], "'p.x -> p' has ports on one side only", ""),
        (["p: {times: 2, of: A}", "c: {connect: p -> p, exclude: [§p -> c]}"], "unknown part 'c'", ""),
        (
            ["p: {times: 2, of: A}", "c: {connect: p -> p, unordered: §true, undirected: true}"],
            "'undirected' makes",
            "",
        ),
        (["p: {times: 2, alternatives: [A, B]}", "c: {connect: p -> p, unordered: §true}"], "'unordered' needs", ""),
        (["p: A", "c: {allocate: [f], to: §q}"], "unknown part 'q'", ""),
        (["p: A", "c: {allocate: [f], to: p, load: §mass}"], "'f' is no part, so it has no 'mass'", "f: {mass: …}"),
        (["p: A", "c: {allocate: {§f: {}}, to: p, load: mass}"], "'f' does not state 'mass'", ""),
        (["p: A", "c: {allocate: [f], to: p, apart: [§[f]]}"], "'apart' needs two functions or more", ""),
        (["p: A", "c: {allocate: [f, g], to: p, apart: [[f, §h]]}"], "'h' is not allocated here", "f"),
        (["p: A", "c: {allocate: [f], to: p, redundancy: §0}"], "0 copies of 'f'", "1 or more"),
    ],
)
def test_a_mistake_in_the_structure_is_told_at_its_place(folder, parts, marked, hint):
    text = f"design: tried\nroot:\n  compound:\n{''.join(f'    {part}{chr(10)}' for part in parts)}"
    line, column = next((n, each.index("§") + 1) for n, each in enumerate(text.splitlines(), 1) if "§" in each)
    with pytest.raises(DseError) as caught:
        read(folder, text.replace("§", ""))
    (problem,) = caught.value.problems
    assert marked in problem.what
    assert hint in problem.hint
    assert (problem.where.line, problem.where.column) == (line, column)


@pytest.mark.parametrize(
    ("rule", "column", "what"),
    [
        ("each(s is A)", 1, "'each' names no repeated place"),
        ("each(p is D)", 11, "'D' cannot be chosen for 'p.n1'"),
        ("count(p.cost > 1) > 0", 9, "nothing at 'p.n1' states 'cost'"),
        ("all_different(s)", 1, "'all_different' needs two places or more, or a repeated one"),
        ("ordered(p, q)", 12, "unknown place 'q'"),
        ("sum(p.mass) < 3 EUR", 15, "cannot compare"),
    ],
)
def test_a_mistake_in_a_formula_over_instances_is_told_at_its_place(folder, rule, column, what):
    parts = f"{{s: A, p: {{times: 2, {OPTIONS}}}}}"
    text = f"design: tried\nroot: {{compound: {parts}}}\nconstraints:\n  c:\n    require: {rule}\n"
    with pytest.raises(DseError) as caught:
        raise DseError(*check_space(read(folder, text)))
    (problem,) = caught.value.problems
    assert what in problem.what
    assert (problem.where.line, problem.where.column) == (5, 13 + column)


def test_a_connection_that_depends_on_a_choice_replaces_one_that_does_not(wired):
    text = WIRED.replace("world.gap -> camera.gap]", "world.gap -> camera.gap, world.gap -> fusion.target_3, LAST]")
    last = "radar.n1.target -> fusion.target_3 if radar.n2 is present"
    space = read(Path(wired.where.file).resolve().parents[1], text.replace("LAST", last).replace(", camera.target", ""))
    for each in open_space(space).configurations():
        sources = {wire.source for wire in each.connections if wire.target == "fusion.n1.target_3"}
        assert sources == {"radar.n1.target" if "radar.n2" in each.parts else "world.gap"}


def test_alternatives_of_one_interface_are_wired_apart_where_a_connection_depends_on_them(wired):
    root = Path(wired.where.file).resolve().parents[1]
    parts = "{r: radar, s: {alternatives: [radar, other]}, w: world}"
    wires = "[w.gap -> s.gap, w.gap -> r.gap if s is other, s.target -> r.gap if s is radar]"
    (root / "components/other.yaml").write_text("components: {other: {implements: sensing}}\n", encoding="utf-8")
    space = read(root, f"design: tried\nroot: {{compound: {parts}, connections: {wires}}}\n")
    found = {
        each.choices["s"]: {str(wire) for wire in each.connections if wire.target == "r.gap"}
        for each in open_space(space).configurations()
    }
    assert found == {"radar": {"s.target -> r.gap"}, "other": {"w.gap -> r.gap"}}


def test_a_connection_that_depends_on_no_choice_is_refused(wired, tmp_path):
    (wire, *others) = (one for one in wired.root.connections if one.when)
    wrong = replace(wire, when=("feeds.fusion_9", ()))
    (problem,) = check_space(replace(wired, root=replace(wired.root, connections=(wrong, *others))))
    assert problem.what.endswith("unknown choice 'feeds.fusion_9'")


def test_an_allocation_is_described_with_the_loads_and_capacities_of_a_configuration(folder):
    use = "{allocate: {f: {mass: 500 g}, g: {mass: 1 kg}}, to: q, load: mass}"
    parts = (
        "s: {alternatives: [A, B]}",
        "o: {optional: A}",
        "t: {times: 2, alternatives: [C, D]}",
        "placement: {allocate: [s, o], to: t, load: mass, redundancy: {s: 2}}",
        f"bay: {{optional: {{compound: {{q: D, use: {use}}}}}}}",
    )
    rules = "{one: {require: s is B and placement.o is t_2 and bay is present and t.n1 is C and t.n2 is D}}"
    space = space_of(folder, *parts, rules=rules)
    (found,) = [describe_configuration(each, space) for each in open_space(space).configurations()]
    hosts = ("t_1", "t_2")
    loads = DefinedLoad("mass", "mass", "kg", {"s": 2.0, "o": 1.0}, {"t_1": 4.0, "t_2": 8.0})
    inner = DefinedLoad("mass", "mass", "kg", {"f": 0.5, "g": 1.0}, {"q": 8.0})
    assert found.allocations == (
        DefinedAllocation("placement", hosts, ("s", "o"), {"s": hosts, "o": ("t_2",)}, (loads,)),
        DefinedAllocation("bay.use", ("q",), ("f", "g"), {"f": ("q",), "g": ("q",)}, (inner,)),
    )
    without = space_of(folder, *parts, rules="{one: {require: o is absent and bay is absent}}")
    for configuration in open_space(without).configurations():
        (only,) = describe_configuration(configuration, without).allocations
        assert only.on == {"s": hosts}
