"""What the expression language reads, and how it says that it cannot."""

from __future__ import annotations

from fractions import Fraction

import pytest

from dse.domain.expression import Between, Binary, Call, Chosen, Conditional, Name, Number, Truth, Unary
from dse.errors import DseError, Location
from dse.expression.parse import parse_expression
from dse.expression.tree import children, descend

HERE = Location("designs/car.yaml", 7, 12)


def root(text):
    return parse_expression(text, HERE).root


def shape(node):
    """The tree with brackets everywhere, so that precedence can be read."""
    match node:
        case Number():
            return str((node.si - node.unit.offset) / node.unit.factor) + str(node.unit)
        case Truth():
            return str(node.value).lower()
        case Name():
            return node.path
        case Unary():
            return f"({node.operator} {shape(node.operand)})"
        case Binary():
            return f"({shape(node.left)} {node.operator} {shape(node.right)})"
        case Between():
            return f"({shape(node.value)} between {shape(node.low)} and {shape(node.high)})"
        case Chosen():
            return f"({node.place} in {','.join(node.options)})"
        case Conditional():
            return f"(if {shape(node.condition)} then {shape(node.yes)} else {shape(node.no)})"
        case Call():
            inside = [*map(shape, node.arguments), *(f"{name}={shape(value)}" for name, value in node.options)]
            return f"{node.function}({', '.join(inside)})"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a + b * c ^ d ^ e", "(a + (b * (c ^ (d ^ e))))"),
        ("a - b - c", "((a - b) - c)"),
        ("a / b * c", "((a / b) * c)"),
        ("-a ^ 2", "(- (a ^ 2))"),
        ("-a * b", "((- a) * b)"),
        ("a ^ -b", "(a ^ (- b))"),
        ("not a < b and c", "((not (a < b)) and c)"),
        ("a or b xor c and d", "(a or (b xor (c and d)))"),
        ("a implies b implies c", "(a implies (b implies c))"),
        ("a or b implies c and d", "((a or b) implies (c and d))"),
        ("a iff b implies c", "(a iff (b implies c))"),
        ("x between 1 m and 2 m and y", "((x between 1m and 2m) and y)"),
        ("x not between a and b", "(not (x between a and b))"),
        ("sensor is radar or b", "((sensor in radar) or b)"),
        ("sensor is not radar", "(not (sensor in radar))"),
        ("front.tyre in [a, b]", "(front.tyre in a,b)"),
        ("front.tyre not in [a]", "(not (front.tyre in a))"),
        ("camera is absent", "(camera in absent)"),
        ("camera is not present", "(not (camera in present))"),
        ("if a then b else c + 1", "(if a then b else (c + 1))"),
        ("if a then 1 else if b then 2 else 3", "(if a then 1 else (if b then 2 else 3))"),
        ("(a + b) * c", "((a + b) * c)"),
        ("f()", "f()"),
        ("f(a, b < c, band = 2 %)", "f(a, (b < c), band=2%)"),
        ("(a < b) == (c < d)", "((a < b) == (c < d))"),
        ("true or\n  false", "(true or false)"),
    ],
)
def test_an_expression_is_read_with_the_usual_precedence(text, expected):
    assert shape(root(text)) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("70 km/h", "70km/h"),
        ("70km/h", "70km/h"),
        ("2 %", "2%"),
        ("0.8 1/s", "4/51/s"),
        ("1.3 * (x)", "(13/10 * x)"),
        ("2 * brake.max_deceleration", "(2 * brake.max_deceleration)"),
        ("x <= 3 m/s and y", "((x <= 3m/s) and y)"),
        ("2 m*(x)", "(2m * x)"),
        ("2 m / x", "(2m / x)"),
        ("3 m ^ 2", "(3m ^ 2)"),
        ("3 m^2", "3m^2"),
        ("3 m^x", "(3m ^ x)"),
        ("3 m/s2 * 2", "(3m/s2 * 2)"),
        ("4 N.m + 1 N*m", "(4N.m + 1N*m)"),
        ("5 m-3 m", "(5m - 3m)"),
        ("2 m^-3", "2m^-3"),
        ("3 in [a]", None),
        ("x between 300 kg and 700 kg", "(x between 300kg and 700kg)"),
        ("if x > 2 s then 1 EUR else 2 TOPS", "(if (x > 2s) then 1EUR else 2TOPS)"),
        ("1e3 m", "1000m"),
        (".5", "1/2"),
        ("1/s", "(1 / s)"),
    ],
)
def test_a_unit_ends_where_the_words_joined_without_blanks_end(text, expected):
    if expected is None:
        with pytest.raises(DseError, match="'in' needs a place on its left"):
            root(text)
    else:
        assert shape(root(text)) == expected


def test_a_literal_is_exact_and_in_si():
    assert root("0.1 km") == Number(Fraction(100), root("1 km").unit, (0, 6))


def test_a_negative_celsius_temperature_is_below_freezing():
    assert root("-5 °C").si == Fraction("268.15")


def test_spans_cover_the_text_of_every_part():
    text = "(a + b) * f(c, d = 2 m)"
    expression = parse_expression(text, HERE)
    assert {text[slice(*node.span)] for node in descend(expression.root)} == {
        text,
        "a + b",
        "a",
        "b",
        "f(c, d = 2 m)",
        "c",
        "2 m",
    }


def test_children_are_in_the_order_they_are_written():
    assert [shape(node) for node in children(root("if a then b else c"))] == ["a", "b", "c"]


BROKEN = [
    ("", 0, "the expression is empty"),
    ("  \n ", None, "the expression is empty"),
    ("a <", 3, "expected a value, found the end"),
    ("a < b < c", 6, "comparisons do not chain"),
    ("a == b between 1 and 2", 7, "comparisons do not chain"),
    ("a = b", 2, "'=' gives an option"),
    ("f(a b)", 4, "found 'b'"),
    ("f(a,)", 4, "found ')'"),
    ("f(", 2, "found the end"),
    ("f(a", 1, "'(' is never closed"),
    ("(a", 0, "'(' is never closed"),
    ("a)", 1, "found ')'"),
    ("[a]", 0, "found '['"),
    ("a is", 4, "expected a component's name"),
    ("a is 3", 5, "expected a component's name"),
    ("a is b.c", 5, "expected a component's name"),
    ("a in b", 5, "expected '['"),
    ("a in [b", 5, "'[' is never closed"),
    ("a in []", 6, "expected a component's name"),
    ("2 is b", 0, "needs a place"),
    ("not", 3, "expected a value"),
    ("and b", 0, "expected a value, found 'and'"),
    ("f(x = 1, 2)", 9, "a plain argument after a named one"),
    ("f(x = 1, x = 2)", 9, "'x' is given twice"),
    ("a.b(c)", 0, "'a.b' is not a function"),
    ("a b", 2, "found 'b'"),
    ("a not b", 2, "'not' is between two values"),
    ("x between 1 m", 13, "expected 'and'"),
    ("if a then b", 11, "expected 'else'"),
    ("if a b", 5, "expected 'then'"),
    ("a && b", 2, "'&&' is not known"),
    ("a ** b", 2, "'**' is not known"),
    ("!a", 0, "'!' is not known"),
    ("a ≤ b", 2, "'≤' is not known"),
    ("3 ~ 4", 2, "'~' is not known"),
    ("a \x00", 2, "cannot be read"),
    ("'a'", 0, "is not known"),
    ("2 brake.x", 2, "unknown unit 'brake.x'"),
    ("2 x", 2, "unknown unit 'x'"),
    ("3 m/s_x", 2, "unknown unit 'm/s_x'"),
    ("3 m*speed", 2, "unknown unit 'm*speed'"),
    ("+a", 0, "expected a value"),
    ("1 m 2", 4, "found '2'"),
    ("1.", 1, "'.' is not known"),
    ("a..b", 1, "'.' is not known"),
    ("9" * 101, 0, "more than 100 characters"),
    ("(" * 100_000, 100, "more than 100 levels"),
    ("-" * 100_000, 100, "more than 100 levels"),
    ("not " * 100_000, 400, "more than 100 levels"),
    ("a ^ " * 100_000, 400, "more than 100 levels"),
    ("f(" * 100_000, 200, "more than 100 levels"),
    (" - ".join("a" * 5000), 0, "more than 200 levels"),
]


@pytest.mark.parametrize(("text", "offset", "what"), BROKEN, ids=[text[:20] for text, _, _ in BROKEN])
@pytest.mark.sampled(6)
def test_what_cannot_be_read_is_refused_at_its_column_with_a_caret(text, offset, what):
    with pytest.raises(DseError) as caught:
        parse_expression(text, HERE)
    (problem,) = caught.value.problems
    assert what in problem.what
    expected = HERE if offset is None else Location(HERE.file, HERE.line, HERE.column + offset)
    if "levels" in what and offset == 0:
        assert problem.where.line == HERE.line
    else:
        assert problem.where == expected
    advice, shown, caret = problem.hint.split("\n")
    assert advice
    assert caret.strip() == "^"
    if offset and len(text) < 80:
        assert shown[caret.index("^") : caret.index("^") + 1] == text[offset : offset + 1]


def test_the_caret_of_a_text_of_several_lines_stands_under_its_own_line():
    with pytest.raises(DseError) as caught:
        parse_expression("a and\n  b and )", HERE)
    (problem,) = caught.value.problems
    assert problem.where == HERE
    _, shown, caret = problem.hint.split("\n")
    assert shown.strip() == "b and )"
    assert shown[caret.index("^")] == ")"


def test_an_expression_without_a_place_in_a_file_can_be_refused_too():
    with pytest.raises(DseError) as caught:
        parse_expression("a <")
    assert caught.value.problems[0].where is None


@pytest.mark.parametrize("operator", ["and", "or", "+", "*"])
def test_a_long_chain_of_an_associative_operator_is_a_tree_of_few_levels(operator):
    names = [f"(a{number})" for number in range(5000)]
    text = f" {operator} ".join(names)
    root = parse_expression(text, HERE).root
    assert [node.path for node in descend(root) if isinstance(node, Name)] == [name.strip("()") for name in names]
    assert root.span == (0, len(text))
    # Brackets belong to the terms they stand around.
    assert text[slice(*root.left.span)].count("(") == text[slice(*root.left.span)].count(")")
