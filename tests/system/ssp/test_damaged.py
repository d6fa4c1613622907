"""A damaged description gives problems at their lines, or another system; never anything else."""

from __future__ import annotations

import re

from hypothesis import example, given, settings, strategies as st
from ssp_packages import (
    METRES_PER_SECOND,
    binding,
    bindings,
    component,
    connection,
    connections,
    connectors,
    description,
    elements,
    entry,
    mapping,
    model,
    parameter_set,
    resolved,
    variable,
)

from dse.errors import DseError

GAIN = model("gain", variable("u", "input"), variable("y", "output"), variable("k", "parameter"))
SPEED = model(
    "speed", variable("u", "input", unit="km/h"), variable("y", "output", unit="m/s"), units=METRES_PER_SECOND
)
UNIT = '<ssd:Units><ssc:Unit name="m/s"><ssc:BaseUnit m="1" s="-1" factor="1" offset="0"/></ssc:Unit></ssd:Units>'
RULES = mapping(entry("a.u", "a.u", '<ssc:LinearTransformation factor="2" offset="1"/>', suppressUnitConversion="true"))
INNER = (
    f'<ssd:System name="s">{connectors("input in", "output out")}'
    + elements(component("g", "input u", "output y", source="resources/gain.fmu"))
    + connections(connection(".in", "g.u"), connection("g.y", ".out"))
    + "</ssd:System>"
)
TEXT = description(
    connectors("input demand", "output speed")
    + bindings(binding(parameter_set("a.u Real 1", "b.k Integer 3"), RULES, prefix=""))
    + elements(
        component("a", "input u", "output y", source="resources/speed.fmu"),
        component("b", "input u", "output y", "parameter k", source="resources/gain.fmu"),
        INNER,
    )
    + connections(
        connection(".demand", "a.u"),
        connection("a.y", "s.in", '<ssc:LinearTransformation factor="2"/>'),
        connection("s.out", "b.u"),
        connection("b.y", ".speed"),
    ),
    UNIT + '<ssd:DefaultExperiment startTime="0" stopTime="2"/>',
)
VALUES = [match.span(1) for match in re.finditer(r'"([^"]*)"', TEXT)]
ODD = ["", "1e400", "NaN", "-1", "..", "#", "%ff", "1 2", "ü", "true"]
WORDS = [*sorted({TEXT[slice(*span)] for span in VALUES}), *ODD]
FMUS = {"gain": GAIN, "speed": SPEED}


# "#" is the description itself, where an FMU should stand.
@example(place=VALUES.index(re.search(r"resources/speed\.fmu", TEXT).span()), word="#")
@settings(max_examples=150, deadline=None)
@given(st.integers(0, len(VALUES) - 1), st.sampled_from(WORDS))
def test_any_word_in_any_place_is_taken_or_refused(tmp_path_factory, place, word):
    start, end = VALUES[place]
    text = TEXT[:start] + word + TEXT[end:]
    problems = ()
    try:
        found = resolved(tmp_path_factory.mktemp("damaged"), text, FMUS)
    except DseError as error:
        problems = error.problems
    if problems:
        assert all("SystemStructure.ssd" in str(problem) for problem in problems)
        return
    assert len(found.structure.elements) == 3
    for wire in found.structure.wires:
        target = found.structure.element(wire.target)
        assert wire.target_variable in {variable.name for variable in target.inputs}
        assert wire.target_variable not in target.start
