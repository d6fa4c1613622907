"""FMI 1.0 descriptions in the words of the later versions."""

from __future__ import annotations

import pytest
from fmu.descriptions import FMI_1 as TEXT

from dse.domain.component import Kind
from dse.domain.fmu import Experiment, FmiInterface


def test_variables_are_called_as_in_fmi_2(described):
    variables = described(TEXT).variables
    shown = {v.name: (v.fmi_type, v.causality, v.variability, v.kind, v.start) for v in variables.values()}
    assert shown == {
        "u": ("Real", "input", "continuous", Kind.REAL, ("0",)),
        "y": ("Real", "output", "continuous", Kind.REAL, ()),
        "z": ("Real", "output", "continuous", Kind.REAL, ()),
        "w": ("Real", "local", "continuous", Kind.REAL, ()),
        "gear": ("Integer", "input", "discrete", Kind.ENUMERATION, ("2",)),
        "k": ("Real", "parameter", "fixed", Kind.REAL, ("3",)),
        "2k": ("Real", "calculatedParameter", "fixed", Kind.REAL, ()),
        "pi": ("Real", "local", "constant", Kind.REAL, ("3.14",)),
        "on": ("Boolean", "local", "discrete", Kind.BOOLEAN, ()),
        "text": ("String", "output", "discrete", None, ()),
    }
    u = variables["u"]
    assert (u.unit, u.minimum, u.maximum, u.nominal) == ("rad", -1, 1, 0.1)
    assert variables["gear"].items == {"P": 1, "D": 2}


def test_an_alias_names_what_it_stands_for_and_a_negated_one_says_so(described):
    variables = described(TEXT).variables
    assert {v.name: (v.alias_of, v.is_negated) for v in variables.values() if v.reference == 2} == {
        "y": ("", False),
        "z": ("y", True),
        "w": ("y", False),
    }


def test_the_rest_of_the_model_is_told_as_in_fmi_2(described):
    found = described(TEXT)
    assert (found.version, found.identifier, found.token) == (1, "m", "{g}")
    assert (found.interface, found.exchange, found.units) == (FmiInterface.CO_SIMULATION, None, {})
    assert (found.depends, found.initially_depends) == ({"y": ("u",), "z": ()}, {})
    assert (found.experiment, found.fixed_step) == (Experiment(0, 2, None, 1e-4), None)
    assert found.capabilities.can_handle_variable_step
    assert found.capabilities.can_interpolate_inputs
    assert not found.capabilities.can_save_state


def test_model_exchange_of_fmi_1_is_refused_by_name(described):
    start, end = TEXT.index("  <Implementation>"), TEXT.index("</fmiModelDescription>")
    told = ["2: the FMU is for model exchange of FMI 1.0, which is not supported"]
    assert described.problems(TEXT[:start] + TEXT[end:]) == told
    told = ["2: model exchange of FMI 1.0 is not supported"]
    assert described.problems(TEXT, FmiInterface.MODEL_EXCHANGE) == told


def test_an_fmu_that_connects_to_its_tool_is_taken_as_the_tool_may_be_there(described):
    assert not described(TEXT).capabilities.needs_tool
    assert described(TEXT.replace("StandAlone", "Tool")).capabilities.needs_tool


def test_an_output_that_depends_on_what_is_not_there_may_depend_on_everything(described):
    assert described(TEXT).depends["y"] == ("u",)
    assert "y" not in described(TEXT.replace("<Name>u</Name>", "<Name>v</Name>")).depends


REFUSALS = {
    "'a/b' is not a modelIdentifier": ('modelIdentifier="m"', 'modelIdentifier="a/b"'),
    "there is no guid": ('guid="{g}"', ""),
    "variable 'text' is a negated alias, but has no opposite": (
        'causality="output"><String/>',
        'causality="output" alias="negatedAlias"><String/>',
    ),
    "<ScalarVariable>: 'causality' cannot be 'local'": ('causality="none"', 'causality="local"'),
    "variable 'on' has no type of FMI 1.0": ("<Boolean/>", "<Flag/>"),
}


@pytest.mark.parametrize("message", REFUSALS)
def test_what_is_missing_or_contradictory_is_told_by_line(described, message):
    old, new = REFUSALS[message]
    line = TEXT[: TEXT.index(old)].count("\n") + 1
    assert described.problems(TEXT.replace(old, new, 1)) == [f"{line}: {message}"]
