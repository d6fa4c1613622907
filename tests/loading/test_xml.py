"""XML that comes from anywhere: elements know their line, and what is unsafe is refused."""

from __future__ import annotations

import math
import string

import pytest
from hypothesis import given, strategies as st

from dse.errors import DseError, Location, Problem
from dse.formats.xml import read_xml, read_xml_file, real_of, whole_of


def refusal(content: bytes) -> str:
    with pytest.raises(DseError) as caught:
        read_xml(content, "a.xml")
    (problem,) = caught.value.problems
    return f"{problem.where}: {problem.what}"


def test_an_element_knows_its_line_its_column_and_what_is_in_it():
    root = read_xml(b'<a x="1">one\n  <b/>two<!-- gone --><c y="2"><b/></c>\n</a>', "a.xml")
    assert (root.tag, root.namespace, root.attributes, root.text.split()) == ("a", "", {"x": "1"}, ["one", "two"])
    assert [child.tag for child in root.children] == ["b", "c"]
    assert [element.where for element in root.walk()] == [
        Location("a.xml", 1, 1),
        Location("a.xml", 2, 3),
        Location("a.xml", 2, 23),
        Location("a.xml", 2, 32),
    ]
    assert [element.where.column for element in root.below("c", "b")] == [32]


def test_namespaces_are_told_apart_whatever_their_prefix_is():
    root = read_xml(b'<p:a xmlns:p="one" xmlns="two" p:x="1" x="2"><b/><p:b/></p:a>', "a.xml")
    assert (root.tag, root.namespace, root.attributes) == ("a", "one", {"{one}x": "1", "x": "2"})
    assert [child.namespace for child in root.all("b")] == ["two", "one"]
    found = root.child("b", "one")
    assert found is root.children[1]
    assert root.child("b", "three") is None


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "a.xml:1:1: not XML: no element found"),
        (b"<a>\n</b>", "a.xml:2:3: not XML: mismatched tag"),
        (b"<a>&b;</a>", "a.xml:1:4: not XML: undefined entity"),
        (b"<a x='1' x='2'/>", "a.xml:1:10: not XML: duplicate attribute"),
        (b'<?xml version="1.0" encoding="klingon"?><a/>', "a.xml:1:31: not XML: unknown encoding: klingon"),
        (b'<?xml version="1.0" encoding="shift_jis"?><a/>', "a.xml:1:31: not XML: multi-byte encodings are not supp"),
        (b'<?xml version="1.0" encoding="rot13"?><a/>', "a.xml:1:31: not XML: 'rot13' is not a text encoding"),
        (b'<?xml version="1.0"?><a x="\xff"/>', "a.xml:1:28: not XML: not well-formed"),
        (b"<a>" * 101, "a.xml:1:301: elements are nested more than 100 levels deep"),
        (b'<!DOCTYPE a SYSTEM "a.dtd"><a/>', "declares a document type or entities, which is refused as unsafe"),
        (b'<!DOCTYPE a [<!ENTITY b "bb">]><a>&b;</a>', "declares a document type or entities"),
        (b'<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]><a>&b;</a>', "declares a document type or entities"),
    ],
)
def test_what_is_no_safe_xml_is_refused_where_it_stands(content, told):
    assert told in refusal(content)


def test_a_prefix_that_is_bound_to_nothing_is_named_and_refused_unless_it_may_be_ignored():
    text = b'<?xml version="1.0"?><!-- <x> -->\n<a xmlns:c="urn:c"><c:d e="b:f"/>\n<b:c d:e="1"/></a>'
    assert "a.xml:3:1: not XML: unbound prefix 'b' 'd'" in refusal(text)
    ignored: list[Problem] = []
    root = read_xml(text, "a.xml", ignored)
    assert [str(problem) for problem in ignored] == [
        f"a.xml:3:1: the prefix '{prefix}' is bound to no namespace" for prefix in "bd"
    ]
    assert [(e.tag, e.namespace, e.where.line) for e in root.walk()] == [
        ("a", "", 2),
        ("d", "urn:c", 2),
        ("c", "unbound:b", 3),
    ]
    assert root.children[1].attributes == {"{unbound:d}e": "1"}


@pytest.mark.parametrize("text", ['<a><b:c xmlns:b="urn:b"/><b:c/></a>', "<b:a></a>"])
def test_a_prefix_that_cannot_be_bound_is_refused(text):
    for told in (None, []):
        with pytest.raises(DseError, match=r"a\.xml:1:.*: not XML: "):
            read_xml(text.encode(), "a.xml", told)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "iso-8859-1", "windows-1252"])
def test_the_encoding_is_the_one_the_file_names(encoding):
    text = f'<?xml version="1.0" encoding="{encoding}"?><a x="ä"/>'
    assert read_xml(text.encode(encoding), "a.xml").attributes == {"x": "ä"}


def test_files_that_are_not_there_or_too_large_are_told(tmp_path):
    with pytest.raises(DseError, match=r"^b\.xml: there is no such file"):
        read_xml_file(tmp_path / "b.xml", "b.xml")
    large = tmp_path / "c.xml"
    with large.open("wb") as file:
        file.truncate(129 * 2**20)
    with pytest.raises(DseError, match=r"^c\.xml: larger than 128 MiB"):
        read_xml_file(large, "c.xml")


def test_values_are_read_as_xml_schema_writes_them_and_problems_stand_where_they_are():
    root = read_xml(b'<a r=" 1.5e3 " i="INF" w="-7" f="1" k="two" bad="1,5" big="300"/>', "a.xml")
    problems = []
    assert (root.real("r", problems), root.real("i", problems), root.real("none", problems)) == (
        1500,
        math.inf,
        None,
    )
    assert (root.whole("w", problems), root.flag("f", problems), root.flag("none", problems)) == (-7, True, False)
    assert root.word("k", ("one", "two"), problems) == "two"
    assert not problems
    assert root.real("bad", problems) is None
    assert root.whole("big", problems, most=255) is None
    assert root.whole("w", problems, least=0) is None
    assert not root.flag("k", problems)
    assert root.word("k", ("one", "three"), problems, "one") == "one"
    assert root.required("none", problems) == ""
    assert [problem.what for problem in problems] == [
        "<a>: 'bad' is '1,5', not a number",
        "<a>: 'big' is '300', not at most 255",
        "<a>: 'w' is '-7', not at least 0",
        "<a>: 'k' is 'two', not true or false",
        "<a>: 'k' cannot be 'two'",
        "<a> has no 'none'",
    ]
    assert {problem.where for problem in problems} == {Location("a.xml", 1, 1)}


@given(st.floats(allow_nan=False))
def test_every_number_is_read_back_as_it_was_written(value):
    text = {math.inf: "INF", -math.inf: "-INF"}.get(value, repr(value))
    assert real_of(text) == value


@given(st.text(alphabet=string.digits + "+-.eE_xinfNaINF ", max_size=12))
def test_only_the_numbers_of_xml_schema_are_numbers(text):
    try:
        expected = float(text)
    except ValueError:
        assert real_of(text) is None
        return
    # Python knows more spellings: underscores, and infinities in any case.
    found = real_of(text)
    assert found is None or found == expected or (math.isnan(found) and math.isnan(expected))
    if whole_of(text) is not None:
        assert whole_of(text) == int(text) == expected
