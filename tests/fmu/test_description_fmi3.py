"""What FMI 3.0 descriptions say: all types, arrays, aliases, and the structure by value references."""

from __future__ import annotations

import pytest
from fmu.descriptions import FMI_3 as TEXT
from hypothesis import HealthCheck, given, settings, strategies as st

from dse.domain.component import Kind
from dse.domain.fmu import ClockKind, Exchange, FmiInterface, Timing


def test_every_type_is_read_by_its_own_functions(described):
    variables = described(TEXT).variables
    shown = {v.name: (v.fmi_type, v.kind, v.variability, v.start) for v in variables.values()}
    assert shown == {
        "time": ("Float64", Kind.REAL, "continuous", ()),
        "n": ("UInt64", Kind.INTEGER, "fixed", ("2",)),
        "three": ("Int8", Kind.INTEGER, "constant", ("3",)),
        "u": ("Float64", Kind.REAL, "continuous", ("1", "2", "3", "4", "5", "6")),
        "other u": ("Float64", Kind.REAL, "continuous", ("1", "2", "3", "4", "5", "6")),
        "x": ("Float64", Kind.REAL, "continuous", ("0",)),
        "y": ("Float64", Kind.REAL, "continuous", ("0",)),
        "der(x)": ("Float64", Kind.REAL, "continuous", ()),
        "f": ("Float32", Kind.REAL, "continuous", ("0.5",)),
        "i": ("UInt16", Kind.INTEGER, "discrete", ()),
        "b": ("Boolean", Kind.BOOLEAN, "fixed", ("true", "false")),
        "s": ("String", None, "fixed", ("a b", "")),
        "d": ("Binary", None, "discrete", ("00fF",)),
        "e": ("Int64", Kind.ENUMERATION, "discrete", ("5000000000",)),
        "tick": ("Clock", None, "discrete", ()),
        "sampled": ("Float64", Kind.REAL, "discrete", ()),
        "z": ("Float64", Kind.REAL, "continuous", ()),
    }
    assert variables["e"].items == {"off": 0, "far": 5_000_000_000}
    assert [(name, v.clocks) for name, v in variables.items() if v.is_clocked] == [("sampled", (12,))]
    assert variables["tick"].timing == Timing(ClockKind.TRIGGERED)
    assert [name for name, v in variables.items() if v.is_intermediate] == ["u", "other u"]


def test_arrays_know_their_sizes_and_what_sets_them(described):
    variables = described(TEXT).variables
    shown = {v.name: (v.shape, v.sized_by) for v in variables.values() if v.shape and not v.alias_of}
    assert shown == {
        "u": ((2, 3), ("n", "")),
        "x": ((2,), ("n",)),
        "der(x)": ((2,), ("n",)),
        "b": ((2,), ("",)),
        "s": ((2,), ("",)),
        "z": ((2,), ("n",)),
    }
    assert variables["u"].labels == ("u[1,1]", "u[1,2]", "u[1,3]", "u[2,1]", "u[2,2]", "u[2,3]")


def test_an_alias_is_another_name_of_the_same_variable(described):
    variables = described(TEXT).variables
    alias, variable = variables["other u"], variables["u"]
    assert (alias.reference, alias.shape, alias.causality) == (variable.reference, variable.shape, "input")
    assert (alias.alias_of, alias.description, variable.alias_of) == ("u", "another name", "")
    assert (variables["y"].alias_of, variables["y"].unit) == ("x", "m")


def test_dependencies_name_every_alias(described):
    found = described(TEXT)
    assert found.depends == {"x": (), "y": (), "i": ("u", "other u")}
    assert found.initially_depends == {"x": (), "y": (), "i": ("b", "e")}


def test_an_fmu_that_can_return_early_when_asked_may_do_so(described):
    text = TEXT.replace("mightReturnEarlyFromDoStep", "canReturnEarlyAfterIntermediateUpdate")
    assert described(text).capabilities.can_return_early
    assert not described(
        text.replace('IntermediateUpdate="true"', 'IntermediateUpdate="false"', 1)
    ).capabilities.can_return_early


def test_capabilities_are_told_in_both_interfaces(described):
    found = described(TEXT)
    assert (found.interface, found.fixed_step, found.title) == (FmiInterface.CO_SIMULATION, 0.01, "The model")
    said = found.capabilities
    assert said.can_save_state
    assert said.has_event_mode
    assert said.can_return_early
    assert said.provides_intermediate_update
    assert said.provides_directional_derivatives
    assert not said.can_handle_variable_step
    assert not said.once_per_process
    found = described(TEXT, FmiInterface.MODEL_EXCHANGE)
    # Counts are of values: both states and both indicators are arrays of two.
    assert found.exchange == Exchange((4,), (5,), 2, 2, needs_completed_step=True, event_indicators=(14,))


U = '<Float64 name="u" valueReference="3" causality="input" start="1 2 3 4 5 6" intermediateUpdate="true">'
SECOND = '<Dimension valueReference="2"/>'

REFUSALS = {
    "there is no instantiationToken": ('instantiationToken="{g}"', ""),
    "variable 'i' has the value reference 6, which is that of 'f'": (
        '"i" valueReference="7"',
        '"i" valueReference="6"',
    ),
    "variable 'u' is sized by value reference 6, no structural parameter with a start": (
        SECOND,
        SECOND.replace("2", "6"),
    ),
    "variable 'u' is sized by value reference 99, no structural parameter with a start": (
        SECOND,
        SECOND.replace("2", "99"),
    ),
    "variable 'u': a dimension has either a 'start' or a 'valueReference'": (SECOND, "<Dimension/>"),
    "variable 'b' has 2 start values for 3 elements": (
        '<Dimension start="2"/></Boolean>',
        '<Dimension start="3"/></Boolean>',
    ),
    "variable 'f' has 2 start values for a single one": ('start="0.5"', 'start="0.5 1"'),
    "variable 'b' has more than 10,000,000 elements": (
        '<Dimension start="2"/></Boolean>',
        '<Dimension start="99999"/><Dimension start="99999"/></Boolean>',
    ),
    "variable 'i': the start value '65536' is not from 0 to 65535": (
        '<UInt16 name="i"',
        '<UInt16 start="65536" name="i"',
    ),
    "variable 'i': the start value '-1' is not from 0 to 65535": ('<UInt16 name="i"', '<UInt16 start="-1" name="i"'),
    "variable 'f': the start value '1e39' is not in the range of Float32": ('start="0.5"', 'start="1e39"'),
    "variable 'd': the start value '0ff' is not a text of hexadecimal digits": ('"00fF"', '"0ff"'),
    "variable 'f' has no type of FMI 3.0": ('<Float32 name="f"', '<Real name="f"'),
}


@pytest.mark.parametrize("message", REFUSALS)
def test_what_is_missing_or_contradictory_is_told_by_line(described, message):
    old, new = REFUSALS[message]
    line = TEXT[: TEXT.index(old)].count("\n") + 1
    assert described.problems(TEXT.replace(old, new, 1)) == [f"{line}: {message}"]


UNRELIABLE = {
    "an output at no variable": ('<Output valueReference="7"', '<Output valueReference="44"'),
    "a dependency on no variable": ('"3 6"', '"33 6"'),
    "two different things of one output": ('<Output valueReference="4"', '<Output valueReference="7"'),
}


@pytest.mark.parametrize("fault", UNRELIABLE)
def test_an_output_of_which_nothing_reliable_is_said_may_depend_on_everything(described, fault):
    assert "i" in described(TEXT).depends
    assert "i" not in described(TEXT.replace(*UNRELIABLE[fault], 1)).depends


def test_an_array_may_have_no_elements(described):
    text = TEXT.replace('<Dimension start="2"/></Boolean>', '<Dimension start="0"/></Boolean>')
    for start in ("", 'start=""'):
        b = described(text.replace('start="true false"', start)).variables["b"]
        assert (b.shape, b.size, b.labels, b.start) == ((0,), 0, (), ())


def test_a_state_and_its_derivative_have_the_same_size(described):
    text = TEXT.replace('derivative="4"><Dimension valueReference="1"/>', 'derivative="4">')
    assert described.problems(text, FmiInterface.MODEL_EXCHANGE) == [
        "22: 'der(x)' and its state 'x' are arrays of different sizes"
    ]


def test_an_enormous_number_of_elements_is_refused_before_it_is_stored(described):
    arrays = "".join(
        f'<Float64 name="a{n}" valueReference="{100 + n}"><Dimension start="9999999"/></Float64>' for n in range(6)
    )
    text = TEXT.replace("</ModelVariables>", f"{arrays}</ModelVariables>")
    assert described.problems(text) == ["0: all arrays together have more than 50,000,000 elements"]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40, deadline=None)
@given(st.lists(st.integers(1, 4), min_size=1, max_size=3), st.data())
def test_every_value_of_an_array_has_a_start_and_a_label_of_its_own(described, shape, data):
    size = 1
    for one in shape:
        size *= one
    starts = data.draw(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=size, max_size=size))
    dimensions = "".join(f'<Dimension start="{one}"/>' for one in shape)
    text = TEXT.replace(
        "</ModelVariables>",
        f'<Float64 name="a" valueReference="99" start="{" ".join(map(repr, starts))}">{dimensions}</Float64>'
        "</ModelVariables>",
    )
    variable = described(text).variables["a"]
    assert [float(start) for start in variable.start] == starts
    assert len(set(variable.labels)) == variable.size == size
    assert variable.labels[-1] == f"a[{','.join(map(str, shape))}]"
