"""Whatever stands in a description: it is read, or refused with problems that say where; nothing else happens."""

from __future__ import annotations

import re

import pytest
from fmu.descriptions import FMI_1, FMI_2, FMI_3
from hypothesis import HealthCheck, given, settings, strategies as st

from dse.domain.fmu import FmiInterface
from dse.errors import DseError

TEXTS = {1: FMI_1, 2: FMI_2, 3: FMI_3}
VALUES = ("", "0", "1", "-1", "2 3", "1e400", "9" * 200, "NaN", "INF", "true", "x", "input", "../x", "ä\u0660", "\n")
ATTRIBUTE = re.compile(r'(?<=")[^"<>]*(?="[ />])')
ELEMENT = re.compile(r"<[A-Za-z]\w*[^>]*/>")

calm = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=150, deadline=None)


def outcome(described, text, interface):
    try:
        return described(text, interface), ()
    except DseError as error:
        return None, error.problems


def read_or_refused(described, text):
    for interface in (None, *FmiInterface):
        found, problems = outcome(described, text, interface)
        assert {problem.where.file for problem in problems} <= {"m.fmu/modelDescription.xml"}
        if found is None:
            continue
        names = set(found.variables)
        for told in (found.depends, found.initially_depends):
            assert names >= {*told, *(name for known in told.values() for name in known)}
        for variable in found.variables.values():
            assert len(variable.start) in (0, 1, variable.size)
            assert 0 <= variable.reference < 2**32


@pytest.mark.parametrize("version", TEXTS)
@calm
@given(data=st.data())
def test_any_value_of_an_attribute(described, version, data):
    text = TEXTS[version]
    places = list(ATTRIBUTE.finditer(text))
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.sampled_from(places))
        value = data.draw(st.sampled_from(VALUES) | st.sampled_from([one[0] for one in places]))
        text = text[: place.start()] + value + text[place.end() :]
        places = list(ATTRIBUTE.finditer(text))
    read_or_refused(described, text)


@pytest.mark.parametrize("version", TEXTS)
@calm
@given(data=st.data())
def test_any_element_missing_doubled_or_elsewhere(described, version, data):
    text = TEXTS[version]
    places = list(ELEMENT.finditer(text))
    taken, put = data.draw(st.sampled_from(places)), data.draw(st.sampled_from(places))
    lost = data.draw(st.booleans())
    text = text[: put.start()] + taken[0] + text[put.end() if lost else put.start() :]
    read_or_refused(described, text)


@pytest.mark.parametrize("version", TEXTS)
@calm
@given(data=st.data())
def test_any_bytes_in_it_and_any_end(described, version, data):
    content = bytearray(TEXTS[version].encode())
    for _ in range(data.draw(st.integers(0, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    read_or_refused(described, bytes(content[: data.draw(st.integers(0, len(content)))]))
