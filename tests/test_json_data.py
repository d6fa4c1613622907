"""JSON from outside: what is read, and what is refused with one kind of error."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import given, strategies as st
from nasty import NASTY

from dse.json_data import read_json, read_noun

ROOT = Path(__file__).parents[1]

FLAT = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()


@dataclass(frozen=True)
class Noun:
    number: float
    count: int
    text: str = ""
    either: Mapping[str, float] | str = ""
    maybe: float | None = None


@given(st.recursive(FLAT, lambda each: st.lists(each) | st.dictionaries(st.text(), each), max_leaves=20))
def test_what_was_written_is_read(data: object) -> None:
    for text in (json.dumps(data), json.dumps(data, ensure_ascii=False).encode()):
        assert read_json(text) == data


@pytest.mark.parametrize("text", ["9" * 400, "-1" + "0" * 400, "1e999", "-1e400", "NaN", "Infinity", "-Infinity"])
def test_a_number_that_no_float_can_be_is_refused(text: str) -> None:
    for whole in (text, f"[{text}]", f'{{"a": {text}}}'):
        with pytest.raises(ValueError, match="number"):
            read_json(whole)


def test_not_finite_numbers_are_read_where_their_writer_may_have_written_them() -> None:
    found = read_json("[NaN, Infinity, -Infinity, 1e999]", only_finite=False)
    assert [*map(str, found)] == ["nan", "inf", "-inf", "inf"]
    with pytest.raises(ValueError, match="beyond the range"):
        read_json("9" * 400, only_finite=False)


def test_depth_and_size_are_bounded() -> None:
    assert read_json("[" * 65 + "]" * 65)
    assert read_json(json.dumps("[" * 1000)) == "[" * 1000
    for text in ("[" * 66 + "]" * 66, "[" * 900 + "]" * 900, '{"a":' * 66 + "1" + "}" * 66, "[" * 1_000_000):
        with pytest.raises(ValueError, match=r"nested more than 64 levels|Expecting"):
            read_json(text)
    assert read_json('"é"', most=4) == "é"
    with pytest.raises(ValueError, match="more than 3 bytes"):
        read_json('"é"', most=3)


@pytest.mark.parametrize("text", [r'"\ud800"', r'{"\udfff": 1}', r'["\ud83d x"]', '"\ud800"', b'"\xff"', b"\xfe\xff"])
def test_text_that_cannot_be_encoded_is_refused(text: str | bytes) -> None:
    with pytest.raises(ValueError):  # noqa: PT011  # any
        read_json(text)
    assert read_json(r'"\ud83d\ude00"') == "😀"


@pytest.mark.parametrize("text", NASTY, ids=lambda text: text[:12])
def test_every_nasty_text_is_read_or_refused(text: str) -> None:
    for only_finite in (True, False):
        try:
            data = read_json(text, only_finite=only_finite)
        except ValueError:
            continue
        assert not only_finite or math.isfinite(data if isinstance(data, int | float) else 0)
        json.dumps(data, ensure_ascii=False).encode()


@pytest.mark.parametrize(
    ("data", "wrong"),
    [
        ([], "x is not an object"),
        ({"number": 1.0}, "x has no 'count'"),
        ({"number": True, "count": 1}, "x.number is true"),
        ({"number": "1", "count": 1}, 'x.number is "1"'),
        ({"number": 1.0, "count": False}, "x.count is false"),
        ({"number": 1.0, "count": 1.0}, "x.count is 1.0"),
        ({"number": 1.0, "count": 1 << 63}, "x.count is 9223372036854775808"),
        ({"number": 1.0, "count": 1, "text": 1}, "x.text is 1"),
        ({"number": 1.0, "count": 1, "either": {"a": True}}, "x.either.a is true"),
        ({"number": 1.0, "count": 1, "maybe": False}, "x.maybe is false"),
    ],
)
def test_what_is_of_another_type_is_refused_by_its_place(data: object, wrong: str) -> None:
    with pytest.raises(ValueError, match=re.escape(wrong)):
        read_noun(data, Noun, "x")


def test_a_noun_is_read() -> None:
    noun = read_noun({"number": 1, "count": -1, "either": {"a": 2.0}, "more": 1}, Noun, "x")
    assert noun == Noun(1, -1, "", {"a": 2.0})
    assert [*map(type, (noun.number, read_noun(1 << 70, float, "x")))] == [int, float]


READING = {
    "dse/json_data.py": "the reader",
    "dse/fmu/toolchain/compiler.py": "our cache",
    "dse/formats/parse_cache.py": "our cache",
    "dse/modelica/frontend/child.py": "a request of dse, in a process without it",
    "dse/modelica/frontend/sources.py": "our cache",
    "dse/modelica/frontend/process.py": "an expression is as deep as the user's model; anything wrong is FrontEndDied",
    "dse/modelica/translate.py": "our cache",
    "dse/partners/python_class.py": "a resource of an FMU, in a process of it",
    "dse/simulink/declarations.py": "our cache",
    "dse/simulink/parsing.py": "a request of dse, in a process without it",
    "dse/storage/run_store.py": "our cache",
    "dse/testbench/definition.py": "what was written in the same line",
    "dse/testbench/facts.py": "our cache",
    "dse/testbench/numerics.py": "our cache",
    "dse/testing/executors.py": "what the test itself has written",
    "dse/testing/samplers.py": "what the test itself has written",
    "dse/units.py": "our cache",
    "dse/world/sumo/partner.py": "a resource of an FMU, in a process of it",
    "dse/world/sumo/simulation.py": "a resource of an FMU, in a process of it",
}
"""Where JSON is read without bounds, and whose it is."""


def test_json_from_outside_is_read_by_one_reader() -> None:
    texts = {path.relative_to(ROOT).as_posix(): path.read_text("utf-8") for path in (ROOT / "dse").rglob("*.py")}
    found = {name for name, text in texts.items() if re.search(r"\bjson\.loads?\b|\bJSONDecoder\b|receive_json", text)}
    assert found == READING.keys()
