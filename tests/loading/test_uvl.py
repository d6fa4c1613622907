"""What a feature model in UVL means as a design space: one configuration for each valid selection of features."""

from __future__ import annotations

import itertools
from fractions import Fraction

import pytest
from every_configuration import valid
from hypothesis import given, settings, strategies as st

from dse.domain.design import Alternative, Compound, Optional, Part
from dse.loading.uvl.reading import read_uvl, read_uvl_text
from dse.loading.uvl.tokens import Source
from dse.space.check import check_space
from dse.space.decisions import sites
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places


def read(text):
    return read_uvl_text(Source("model.uvl", text))


def count(space):
    return len(valid(space))


def selections(space):
    """The names chosen in every configuration, and those of the places that are there."""
    there = sites(space)
    return [frozenset(site.name for site in there if site.is_there(choices)) for choices in valid(space)]


SANDWICH = """\
namespace Menu

features
    Sandwich {abstract, Price 0.5, maker 'Ann', Size {Width 10}}
        mandatory
            Bread {Price 2.5}
        optional
            Sauce
                alternative
                    Ketchup {Price 1}
                    "Old Mustard" {Price 2}
            Cheese {Price 3.25} // from the farm
        or
            Ham
            Egg
constraints
    Ketchup => Cheese
    sum(Price) <= 7
"""


def test_groups_become_containers():
    space = read(SANDWICH)
    parts = space.root.parts
    assert (space.name, space.title) == ("Sandwich", "Menu")
    assert list(parts) == ["Sandwich_itself", "Bread", "Sauce", "Cheese", "Ham", "Egg"]
    assert isinstance(parts["Bread"], Part)
    assert isinstance(parts["Sauce"], Optional)
    sauce = parts["Sauce"].content
    assert isinstance(sauce, Compound)
    assert isinstance(sauce.parts["Sauce_choice"], Alternative)
    assert [option.name for option in sauce.parts["Sauce_choice"].options] == ["Ketchup", "Old_Mustard"]


def test_numbers_become_exact_properties_and_titles_keep_the_words():
    space = read(SANDWICH)
    itself = space.root.parts["Sandwich_itself"].component
    assert {name: value.si for name, value in itself.properties.items()} == {"Price": Fraction(1, 2), "Size_Width": 10}
    mustard = space.root.parts["Sauce"].content.parts["Sauce_choice"].options[1].component
    assert mustard.title == "Old Mustard"
    assert mustard.interface.ports == ()


def test_constraints_keep_the_words_of_the_file_and_their_place():
    group, first, second = read(SANDWICH).constraints
    assert (first.name, first.because, str(first.where)) == ("c1", "Ketchup => Cheese", "model.uvl:17:5")
    assert (second.name, second.rule.text) == ("c2", "sum(Price) <= 7")
    assert group.name == "Sandwich_group"
    assert str(group.where) == "model.uvl:13:9"


def test_a_model_is_a_sound_design_space_with_a_configuration_for_each_selection():
    space = read(SANDWICH)
    assert check_space(space) == []
    # No sauce 2, mustard 1 (with cheese it costs 8.25), ketchup with cheese 7.25; each with ham, egg or both.
    assert count(space) == 3 * 3


def test_a_root_without_children_is_one_configuration():
    assert count(read("features\n  Alone {Price 3}\nconstraints\n  Alone.Price == 3 & sum(Price) == 3\n")) == 1
    assert count(read("features\n  Alone\n")) == 1


GROUPS = {
    "mandatory": 1, "optional": 8, "alternative": 3, "or": 7, "[1]": 3, "[2]": 3, "[3]": 1, "[1..2]": 6, "[2..3]": 4,
    "[0..1]": 4, "[0..2]": 7, "[1..*]": 7, "[0..*]": 8, "[2..9]": 4, "[1..1]": 3, "[0]": 1,
}  # fmt: skip


@pytest.mark.parametrize(("group", "number"), GROUPS.items(), ids=GROUPS)
def test_a_group_has_as_many_configurations_as_selections(group, number):
    below = f"\n        {group}\n            A\n            B\n            C\n"
    assert count(read(f"features\n    R{below}")) == number
    optional = below.replace("\n", "\n        ").rstrip(" ")
    # Below an optional feature there is one selection more: without it.
    assert count(read(f"features\n    R\n        optional\n            P{optional}")) == number + 1


def test_alternatives_of_one_feature_stand_side_by_side():
    text = "features\n R\n  alternative\n   A\n   B\n  alternative\n   C\n   D\n  optional\n   R_choice\n"
    space = read(text)
    assert list(space.root.parts) == ["R_choice_2", "R_choice_3", "R_choice"]
    assert count(space) == 8


TRUTHS = [
    ("A | B & C", lambda a, b, c: a or (b and c)),
    ("A => B => C", lambda a, b, c: not (not a or b) or c),
    ("A <=> B => C", lambda a, b, c: a == (not b or c)),
    ("!A & B", lambda a, b, c: not a and b),
    ("!(A & B)", lambda a, b, c: not (a and b)),
    ("!!A", lambda a, b, c: a),
    ("true & A", lambda a, b, c: a),
    ("A | false", lambda a, b, c: a),
    ("R => A", lambda a, b, c: a),
    ("!A.x == 2", lambda a, b, c: not a),
    ("A.x == 2", lambda a, b, c: a),
    ("A.x + B.x - C.x > 0", lambda a, b, c: 2 * a + 3 * b + c > 0),
    ("A.x - B.x - C.x == 3", lambda a, b, c: 2 * a - 3 * b + c == 3),
    ("2 * A.x / 4 + .5 >= 1.5", lambda a, b, c: a),
    ("-(A.x) < -1", lambda a, b, c: a),
    ("sum(x) != 5", lambda a, b, c: 2 * a + 3 * b - c != 5),
    ("sum(x, R) >= 4", lambda a, b, c: 2 * a + 3 * b - c >= 4),
    ("sum(x, A) == 0", lambda a, b, c: not a),
    ("avg(x) < 1", lambda a, b, c: not (a or b or c) or (2 * a + 3 * b - c) < (a + b + c)),
    ("floor(B.x / 2) == 1", lambda a, b, c: b),
    ("ceil(B.x / 2) == 2", lambda a, b, c: b),
    ("(A.x + B.x) * 2 > 9 | (C & !A)", lambda a, b, c: (a and b) or (c and not a)),
    ("A.x > 1 & B.x < 1 => C", lambda a, b, c: not (a and not b) or c),
    ('"A" =>\tB /* so */ & C', lambda a, b, c: not a or (b and c)),
]
SHAPES = {
    "optional": ("optional\n   A {x 2}\n   B {x 3}\n   C {x -1}\n", list(itertools.product((False, True), repeat=3))),
    "alternative": ("[0..1]\n   A {x 2}\n   B {x 3}\n   C {x -1}\n", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("constraint", "meaning"), TRUTHS, ids=[text for text, _ in TRUTHS])
def test_a_constraint_means_what_it_says(shape, constraint, meaning):
    group, worlds = SHAPES[shape]
    space = read(f"features\n R\n  {group}constraints\n {constraint}\n")
    found = {tuple(bool(name in chosen) for name in "ABC") for chosen in selections(space)}
    assert found == {tuple(map(bool, world)) for world in worlds if meaning(*map(bool, world))}


def test_a_sum_below_one_of_several_alternatives_leaves_the_others_out():
    tree = "features\n R\n  [0..1]\n   A {x 2}\n    optional\n     A1 {x 5}\n    alternative\n     A2 {x 1}\n     A3\n   B {x 7}\n"
    sums = {total: count(read(f"{tree}constraints\n sum(x, A) == {total}\n")) for total in range(9)}
    assert sums == {0: 2, 1: 0, 2: 1, 3: 1, 4: 0, 5: 0, 6: 0, 7: 1, 8: 1}


def test_constraints_among_attributes_count_like_others():
    text = "features\n R\n  optional\n   A {constraints [A => B, C => !B], Cost 1}\n   B {constraint !C}\n   C\n"
    space = read(text)
    assert [constraint.because for constraint in space.constraints] == ["A => B", "C => !B", "!C"]
    assert count(space) == 3


def test_brackets_go_on_over_lines_and_comments_stand_anywhere():
    text = "/* a\nb */ features // x\n R {Price 1,\n Width 2}\n  // note\n  optional\n\n   A\n constraints\n"
    text = text.replace("\n constraints", "\nconstraints\n (A\n & R) // end\n /* last */")
    assert count(read(text)) == 1


@pytest.mark.parametrize("end", ["\r\n", "\r", "\n"])
def test_lines_may_end_as_any_system_ends_them(end):
    space = read(SANDWICH.replace("\n", end))
    assert count(space) == 9
    assert str(space.constraints[1].where) == "model.uvl:17:5"


def test_names_that_expressions_cannot_have_are_spelled_otherwise_and_stay_apart():
    space = read(
        'features\n R\n  optional\n   "a b"\n   a_b\n   "a-b"\n   is\n   "2G"\n   "é"\n   "present"\nconstraints\n "a b" => is\n'
    )
    assert list(space.root.parts) == ["a_b_2", "a_b", "a_b_3", "is_", "x2G", "x_", "present_"]
    assert count(space) == 2**6 * 3 // 2


@pytest.mark.thorough
def test_a_chain_of_many_features_and_numbers_is_no_deep_tree():
    names = [f"F{number}" for number in range(2000)]
    tree = "features\n R\n  optional\n" + "".join(f"   {name} {{x 1}}\n" for name in names)
    chains = [" | ".join(names), " & ".join(names), " + ".join(f"{name}.x" for name in names) + " > 3"]
    space = read(f"{tree}constraints\n" + "".join(f" {chain}\n" for chain in chains))
    places = Places(space)
    nothing = [compile_in(constraint.rule, places).outcome({}) for constraint in space.constraints]
    everything = {name: name for name in names}
    assert nothing == [False, False, False]
    assert all(compile_in(constraint.rule, places).outcome(everything) for constraint in space.constraints)


def test_a_tree_of_100_levels_is_a_design_space():
    text = "features\n"
    for level in range(99):
        text += " " * (2 * level + 1) + f"F{level}\n" + " " * (2 * level + 2) + ("optional\n", "[0..1]\n")[level % 2]
    text += " " * 300 + "Last\n"
    space = read(text)
    assert check_space(space) == []
    assert count(space) == 100


@st.composite
def models(draw):
    """Text of a model of up to nine features, and the same as data."""
    number = draw(st.integers(1, 9))
    prices = [draw(st.none() | st.integers(-3, 9)) for _ in range(number)]
    groups = {0: []}
    for child in range(1, number):
        parent = draw(st.integers(max(0, child - 4), child - 1))
        groups.setdefault(child, [])
        if groups[parent] and draw(st.booleans()):
            groups[parent][-1][1].append(child)
        else:
            groups[parent].append(["", [child]])
    lines = []

    def emit(feature, indent):
        price = "" if prices[feature] is None else f" {{Price {prices[feature]}}}"
        lines.append(f"{' ' * indent}f{feature}{price}")
        for group in groups[feature]:
            size = len(group[1])
            low = draw(st.integers(0, size))
            high = draw(st.integers(max(low, 1), size))
            group[0] = draw(st.sampled_from(["mandatory", "optional", "alternative", "or", f"[{low}..{high}]"]))
            lines.append(f"{' ' * (indent + 1)}{group[0]}")
            for child in group[1]:
                emit(child, indent + 2)

    emit(0, 1)
    names = st.integers(0, number - 1)
    conditions = st.recursive(
        names.map(lambda f: (f"f{f}", lambda chosen: f in chosen)),
        lambda inner: st.one_of(
            inner.map(lambda c: (f"!({c[0]})", lambda chosen: not c[1](chosen))),
            st.tuples(inner, st.sampled_from(["&", "|", "=>", "<=>"]), inner).map(_joined),
        ),
        max_leaves=5,
    )
    rules = draw(st.lists(conditions, max_size=2))
    stated = [f for f in range(number) if prices[f] is not None]
    if stated:
        bound = draw(st.integers(-5, 20))
        rules.append((f"sum(Price) <= {bound}", lambda chosen: sum(prices[f] for f in stated if f in chosen) <= bound))
        terms = draw(st.lists(st.sampled_from(stated), min_size=1, max_size=3, unique=True))
        low = draw(st.integers(-5, 5))
        text = " + ".join(f"f{f}.Price" for f in terms)
        rules.append((f"{text} >= {low}", lambda chosen: sum(prices[f] for f in terms if f in chosen) >= low))
    text = "features\n" + "\n".join(lines) + "\nconstraints\n" + "".join(f" {rule[0]}\n" for rule in rules)
    return text, number, groups, [rule[1] for rule in rules]


def _joined(pieces):
    (left, a), operator, (right, b) = pieces
    meaning = {
        "&": lambda chosen: a(chosen) and b(chosen),
        "|": lambda chosen: a(chosen) or b(chosen),
        "=>": lambda chosen: not a(chosen) or b(chosen),
        "<=>": lambda chosen: a(chosen) == b(chosen),
    }
    return f"({left}) {operator} ({right})", meaning[operator]


def _fits(chosen, groups):
    if 0 not in chosen:
        return False
    for parent, below in groups.items():
        for word, children in below:
            number = sum(child in chosen for child in children)
            size = len(children)
            if word.startswith("["):
                low, high = map(int, word[1:-1].split(".."))
            else:
                low, high = {"mandatory": (size, size), "optional": (0, size), "alternative": (1, 1), "or": (1, size)}[
                    word
                ]
            if (parent in chosen and not low <= number <= high) or (parent not in chosen and number):
                return False
    return True


@pytest.mark.thorough
@settings(max_examples=300, deadline=None)
@given(models())
def test_the_configurations_are_the_valid_selections(model):
    text, number, groups, rules = model
    features = {f"f{feature}" for feature in range(number)}
    expected = set()
    for mask in itertools.product((False, True), repeat=number):
        chosen = {feature for feature in range(number) if mask[feature]}
        if _fits(chosen, groups) and all(rule(chosen) for rule in rules):
            expected.add(frozenset(f"f{feature}" for feature in chosen - {0}))
    found = [chosen & features - {"f0"} for chosen in selections(read(text))]
    assert len(found) == len(set(found))
    assert set(found) == expected


def test_a_file_is_read_from_disk(tmp_path):
    path = tmp_path / "menu.uvl"
    path.write_text("\ufeff" + SANDWICH, encoding="utf-8")
    assert count(read_uvl(path)) == 9


def test_no_name_starts_as_files_for_including_do():
    space = read('features\n "../../x" {"_y" 1}\n  optional\n   "_z"\n')
    assert (space.name, list(space.root.parts)) == ("x______x", ["x______x_itself", "x_z"])
