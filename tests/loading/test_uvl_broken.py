"""Every mistake in a UVL file, and everything that is not understood, is named at its character."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given, settings, strategies as st

from dse.errors import DseError
from dse.loading.uvl.reading import read_uvl, read_uvl_text
from dse.loading.uvl.tokens import Source

GOOD = """\
namespace Menu

include
    Boolean.group-cardinality
    Arithmetic.*

features
    Meal {Price 2, City 'Rome', Size {Width 3}, colors ['red', 'blue']}
        mandatory
            Bread {abstract true}
        alternative
            Soup {Price 3}
            Salad
        [1..2]
            Ham
            Egg
constraints
    Ham => Salad
    sum(Price) < 8
"""


def problems_of(text):
    with pytest.raises(DseError) as caught:
        read_uvl_text(Source("m.uvl", text))
    return caught.value.problems


CASES = [
    # what is not understood
    ("import", "include\n", "imports\n    a.b as c\ninclude\n", "4:5", "the import of 'a' is not supported", "one file"),
    ("typed feature", "Ham\n", "Integer Ham\n", "15:13", "features of type Integer are not supported", "attribute"),
    ("text feature", "Salad\n", "String Salad\n", "13:13", "features of type String are not supported", "attribute"),
    ("clones", "Salad\n", "Salad cardinality [1..3]\n", "13:19", "feature 'Salad' has a cardinality", "one feature for each"),
    ("feature of another model", "Salad\n", "sub.Salad\n", "13:13", "'sub. …' is a feature of another model", "one file"),
    ("text in a constraint", "sum(Price) < 8", "Meal.Price == 'x'", "19:19", "constraints on texts are not supported", ""),
    ("text attribute in a constraint", "sum(Price) < 8", "Meal.City == 3", "19:5", "'Meal.City' is text, and constraints take numbers", ""),
    ("list in a constraint", "sum(Price) < 8", "Meal.colors > 3", "19:5", "'Meal.colors' is a list", ""),
    ("group of attributes in a constraint", "sum(Price) < 8", "Meal.Size > 3", "19:5", "'Meal.Size' is a group of attributes", ""),
    ("truth in a constraint", "sum(Price) < 8", "Bread.abstract == 1", "19:5", "'Bread.abstract' is true or false", ""),
    ("length", "sum(Price) < 8", "len(City) < 8", "19:5", "'len' is not supported", ""),
    ("unknown level", "Arithmetic.*", "Arithmetik", "5:5", "unknown language level 'Arithmetik'", "Arithmetic"),
    ("unknown minor level", "group-cardinality", "group", "4:5", "unknown language level 'Boolean.group'", "group-cardinality"),
    # sections
    ("unknown section", "features\n", "feature\n", "7:1", "'feature' is not a section", "features"),
    ("section twice", "constraints\n", "constraints\n    Ham\nconstraints\n", "19:1", "a second section 'constraints'", "join"),
    ("something after a section", "constraints\n", "constraints Ham\n", "17:13", "unexpected 'Ham' after 'constraints'", "below"),
    # the tree
    ("two roots", "constraints\n", "    Other\nconstraints\n", "17:5", "a second root feature", "'Meal'"),
    ("odd indentation", "        [1..2]", "      [1..2]", "14:7", "the indentation fits no line above", "align"),
    ("feature below a feature", "        mandatory\n            Bread", "        Wine\n        mandatory\n            Bread", "9:9", "expected a group below feature 'Meal', found 'Wine'", "mandatory"),
    ("misspelled group", "alternative\n", "alternatives\n", "11:9", "expected a group below feature 'Meal', found 'alternatives'", "did you mean 'alternative'?"),
    ("something after a group", "mandatory\n", "mandatory x\n", "9:19", "unexpected 'x' after 'mandatory'", "line of its own"),
    ("empty group", "        [1..2]", "        or\n        [1..2]", "14:9", "the group 'or' has no features", "indent"),
    ("feature twice", "            Egg", "            Soup", "16:13", "feature 'Soup' is defined twice", "line 12"),
    ("empty range", "[1..2]", "[2..1]", "14:10", "the range [2..1] is empty", "[1..2]"),
    ("range beyond the group", "[1..2]", "[3..4]", "14:9", "[3..4] asks for 3 features of a group of 2", "[2..2]"),
    ("range of no number", "[1..2]", "[1..n]", "14:13", "expected a whole number, found 'n'", "[1..3]"),
    ("range of a fraction", "[1..2]", "[1.5]", "14:10", "expected a whole number, found '1.5'", "[1..3]"),
    ("name that starts with a digit", "Salad\n", "2Salad\n", "13:13", "expected a feature's name, found '2'", '"2"'),
    ("two names", "Salad\n", "Green Salad\n", "13:19", "expected the end of the line, found 'Salad'", ""),
    # attributes
    ("attribute twice", "{Price 2,", "{Price 2, Price 3,", "8:20", "attribute 'Price' is defined twice at 'Meal'", "remove"),
    ("attribute without a comma", "{Price 2,", "{Price 2 Cost 3,", "8:19", "expected ',' or '}', found 'Cost'", ""),
    ("bare word for a value", "City 'Rome'", "City Rome", "8:25", "expected a value, found 'Rome'", "quotes"),
    ("number without bounds", "Price 3", "Price 1e999", "12:25", "beyond the range of numbers", "smaller"),
    ("minus and no number", "Price 3", "Price -x", "12:26", "expected a number, found 'x'", ""),
    ("bracket never closed", "{Price 3}", "{Price 3", "12:18", "'{' is never closed", "add '}'"),
    ("bracket closed by another", "{Price 3}", "{Price 3)", "12:26", "')' does not close '{' of 12:18", "write '}'"),
    ("bracket that closes nothing", "Ham => Salad", "Ham => Salad)", "18:17", "')' closes nothing", "remove"),
    # characters
    ("quote never closed", "Salad\n", '"Salad\n', "13:13", '" is never closed', "same line"),
    ("comment never closed", "            Salad\n", "            /* Salad\n", "13:13", "/* is never closed", "close"),
    ("foreign sign", "Ham => Salad", "Ham → Salad", "18:9", "'→' is not known here", "write =>"),
    ("double sign", "Ham => Salad", "Ham && Salad", "18:9", "'&&' is not known here", "write &"),
    ("single equals", "< 8", "= 8", "19:16", "'=' is not known here", "write =="),
    ("text turned round", "'Rome'", "'Ro\u202eme'", "8:28", "the character U+202E cannot be used in a text", "does not show"),
    # constraints
    ("unknown feature", "Ham => Salad", "Ham => Sallad", "18:12", "unknown feature 'Sallad'", "did you mean 'Salad'?"),
    ("unknown attribute", "sum(Price) < 8", "Soup.Prize < 8", "19:5", "feature 'Soup' has no attribute 'Prize'", "Price"),
    ("sum of nothing", "sum(Price)", "sum(Weight)", "19:9", "no feature has a number called 'Weight'", ""),
    ("sum below no feature", "sum(Price)", "sum(Price, Wine)", "19:16", "unknown feature 'Wine'", ""),
    ("average of nothing", "sum(Price)", "avg(Price, Ham)", "19:5", "neither 'Ham' nor a feature below it has a number called 'Price'", ""),
    ("average below an alternative", "sum(Price)", "avg(Price, Soup)", "19:5", "the average over 'Soup', one feature of an alternative, is not supported", "above"),
    ("number for a condition", "sum(Price) < 8", "sum(Price) + 8", "19:5", "expected a condition, found a number", "compare"),
    ("number beside a condition", "Ham => Salad", "Ham => 3", "18:12", "'=>' joins conditions, and this is a number", "compare"),
    ("feature for a number", "sum(Price) < 8", "8 > Ham", "19:9", "'>' takes numbers, and 'Ham' is a feature", "Ham.attribute"),
    ("features compared", "Ham => Salad", "Ham == Salad", "18:5", "'==' takes numbers, and 'Ham' is a feature", "<=>"),
    ("condition for a number", "sum(Price) < 8", "(Ham & Egg) * 2 > 3", "19:5", "'*' takes numbers, and this is a condition", "&"),
    ("chain of comparisons", "sum(Price) < 8", "1 < sum(Price) < 8", "19:20", "comparisons do not chain", "&"),
    ("nothing after an operator", "Ham => Salad", "Ham =>", "18:11", "expected a feature, a number or '(', found the end of the line", ""),
    ("two features without an operator", "Ham => Salad", "Ham Salad", "18:9", "expected an operator or the end of the line, found 'Salad'", ""),
    ("deep brackets", "Ham => Salad", "(" * 60 + "Ham" + ")" * 60, "18:55", "more than 50 levels deep", "split"),
    ("deep chain", "Ham => Salad", " => ".join(["Ham"] * 300), "18:5", "more than 200 levels deep", "split"),
    ("bad constraint among the attributes", "{Price 3}", "{constraints [Ham, Eg]}", "12:37", "unknown feature 'Eg'", "Egg"),
    ("empty constraint among the attributes", "{Price 3}", "{constraint}", "12:29", "expected a constraint, found '}'", ""),
]  # fmt: skip


def test_the_file_that_is_broken_below_is_good():
    assert len(read_uvl_text(Source("m.uvl", GOOD)).constraints) == 3


@pytest.mark.parametrize(
    ("old", "new", "where", "what", "hint"), [case[1:] for case in CASES], ids=[case[0] for case in CASES]
)
def test_a_mistake_is_named_where_it_stands(old, new, where, what, hint):
    assert old in GOOD
    problem = problems_of(GOOD.replace(old, new, 1))[0]
    assert problem.what.startswith(what)
    assert str(problem.where) == f"m.uvl:{where}"
    assert hint in problem.hint


def test_the_hint_shows_the_line_with_a_caret():
    (problem,) = problems_of(GOOD.replace("Ham => Salad", "Ham => Sallad"))
    assert problem.hint.splitlines()[1:] == ["            Ham => Sallad", "                   ^"]


def test_all_problems_are_told_at_once():
    text = GOOD.replace("mandatory\n", "mandatori\n").replace("Salad\n        [", "Integer Salad\n        [")
    assert [str(problem.where) for problem in problems_of(text)] == ["m.uvl:9:9", "m.uvl:13:13"]
    text = GOOD.replace("Ham => Salad", "Ham => Sallad\n    Egg & 3\n    Egg")
    assert [str(problem.where) for problem in problems_of(text)] == ["m.uvl:18:12", "m.uvl:19:11"]


def test_a_file_of_nothing_but_mistakes_stops_after_a_hundred():
    assert len(problems_of("features\n R\nconstraints\n" + " Q\n" * 1000)) == 100


@pytest.mark.parametrize("text", ["", "\n\n", "namespace X\n", "// nothing\n"])
def test_a_file_without_features_is_refused(text):
    assert problems_of(text)[0].what == "there is no section 'features'"


def test_an_empty_tree_is_refused():
    assert problems_of("features\nconstraints\n")[0].what == "there are no features"


def test_a_tree_beyond_100_levels_is_refused():
    text = "features\n" + "".join(
        f"{' ' * (level + 1)}{'optional' if level % 2 else f'F{level}'}\n" for level in range(999)
    )
    (problem,) = problems_of(text)
    assert problem.what == "more than 100 levels of features"
    assert str(problem.where) == "m.uvl:202:202"


def test_attributes_nest_only_so_deep():
    text = "features\n R {" + "a {" * 500 + "}" * 500 + "}\n"
    assert problems_of(text)[0].what == "attributes more than 20 deep"


def test_a_file_that_is_no_utf8_is_told_at_the_character(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.uvl").write_bytes("features\n Käse ".encode() + b"\xff\n")
    with pytest.raises(DseError) as caught:
        read_uvl(tmp_path / "m.uvl")
    assert str(caught.value.problems[0].where) == "m.uvl:2:7"
    assert caught.value.problems[0].what == "a character that is not UTF-8"


def test_what_is_no_file_is_refused(tmp_path):
    for path, what in ((tmp_path, "this is a folder, not a file"), (tmp_path / "nope.uvl", "no such file")):
        with pytest.raises(DseError, match=what):
            read_uvl(path)


words = st.sampled_from(
    ["features", "constraints", "\n", "\n ", "\n  ", "\n   ", "R", "A", "optional", "or", "[1..2]", "{", "}", "x", "1",
     ",", "=>", "&", "(", ")", "!", "==", "sum", ".", "'t'", '"q"', "/*", "*/", "//", "cardinality", "constraint", "["]
)  # fmt: skip


@pytest.mark.thorough
@settings(max_examples=500, deadline=None)
@given(st.one_of(st.lists(words, max_size=30).map(" ".join), st.text(max_size=30)))
def test_any_text_is_read_or_refused_but_never_breaks_the_reader(text):
    for source in (text, f"features\n R\n{text}", f"features\n R {{x 1}}\n  optional\n   A\nconstraints\n {text}"):
        with contextlib.suppress(DseError):
            read_uvl_text(Source("m.uvl", source))
