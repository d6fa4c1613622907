"""What FMI 2.0 descriptions say, and what is told of those that lack or contradict something."""

from __future__ import annotations

import pytest
from fmu.descriptions import FMI_2 as TEXT

from dse.domain.component import Kind
from dse.domain.fmu import Exchange, Experiment, FmiInterface, UnitDefinition
from dse.errors import DseError
from dse.fmu.reading.description import read_description


def test_every_variable_is_there_with_what_its_type_adds(described):
    variables = described(TEXT).variables
    shown = {v.name: (v.reference, v.fmi_type, v.causality, v.variability, v.kind, v.start) for v in variables.values()}
    assert shown == {
        "u": (1, "Real", "input", "continuous", Kind.REAL, ("0",)),
        "v": (2, "Real", "output", "continuous", Kind.REAL, ()),
        "x": (3, "Real", "local", "continuous", Kind.REAL, ("2.5",)),
        "der(x)": (4, "Real", "local", "continuous", Kind.REAL, ()),
        "gear": (0, "Integer", "input", "discrete", Kind.ENUMERATION, ("4",)),
        "file": (0, "String", "parameter", "fixed", None, (" a b.txt",)),
        "k": (5, "Real", "parameter", "tunable", Kind.REAL, ("1",)),
        "n": (6, "Integer", "local", "discrete", Kind.INTEGER, ()),
        "w": (7, "Boolean", "output", "discrete", Kind.BOOLEAN, ("1",)),
    }
    v = variables["v"]
    assert (v.unit, v.minimum, v.maximum, v.nominal) == ("km/h", 0, 90, 100)
    assert (variables["gear"].items, variables["k"].description) == ({"P": -1, "D": 4}, "gain")
    assert [name for name, one in variables.items() if one.is_relative] == ["x"]


def test_what_takes_no_start_value_is_known(described):
    settable = {name for name, one in described(TEXT).variables.items() if one.is_settable}
    assert settable == {"u", "x", "gear", "file", "k", "w"}
    more = (
        '<ScalarVariable name="c" valueReference="20" causality="calculatedParameter" %s><Real/></ScalarVariable>'
        '<ScalarVariable name="o" valueReference="21" causality="output" %s><Real start="1"/></ScalarVariable>'
        "</ModelVariables>"
    )
    for word, expected in (('initial="calculated"', set()), ('initial="approx"', {"c", "o"}), ("", {"o"})):
        text = TEXT.replace("</ModelVariables>", more % (word, word))
        assert {n for n, v in described(text).variables.items() if v.is_settable} - settable == expected, word


def test_units_are_those_with_a_relation_to_si(described):
    assert described(TEXT).units == {
        "km/h": UnitDefinition(0.2777777777777778, 0.0, {"m": 1, "s": -1}),
        "degC": UnitDefinition(1.0, 273.15, {"K": 1}),
    }


def test_outputs_depend_on_what_the_structure_says_and_else_on_everything(described):
    found = described(TEXT)
    assert found.depends == {"v": ("u",)}
    assert found.initially_depends == {"v": ("u", "k"), "w": ()}


def test_co_simulation_comes_first_and_model_exchange_if_it_is_asked_for(described):
    found = described(TEXT)
    assert (found.interface, found.identifier, found.exchange) == (FmiInterface.CO_SIMULATION, "m", None)
    said = found.capabilities
    assert (said.once_per_process, said.can_interpolate_inputs, said.can_handle_variable_step) == (True, True, False)
    assert (found.fixed_step, found.experiment) == (0.002, Experiment(1, 5, 0.002, 1e-5))
    assert (found.token, found.title, found.version) == ("{g}", "m", 2)
    found = described(TEXT, FmiInterface.MODEL_EXCHANGE)
    assert (found.interface, found.identifier) == (FmiInterface.MODEL_EXCHANGE, "m_me")
    assert found.exchange == Exchange((3,), (4,), 1, 2, needs_completed_step=False)
    assert found.capabilities.provides_directional_derivatives
    assert (found.capabilities.can_handle_variable_step, found.fixed_step) == (True, None)


def test_an_interface_that_needs_a_tool_is_passed_over_if_the_other_does_not(described):
    text = TEXT.replace("<CoSimulation ", '<CoSimulation needsExecutionTool="true" ')
    assert described(text).interface is FmiInterface.MODEL_EXCHANGE
    assert not described(text).capabilities.needs_tool
    found = described(text.replace("<ModelExchange ", '<ModelExchange needsExecutionTool="true" '))
    assert (found.interface, found.capabilities.needs_tool) == (FmiInterface.CO_SIMULATION, True)


CO_SIMULATION = (
    '<CoSimulation modelIdentifier="m" canBeInstantiatedOnlyOncePerProcess="true" canInterpolateInputs="1"/>'
)
MODEL_EXCHANGE = (
    '<ModelExchange modelIdentifier="m_me" providesDirectionalDerivative="true" '
    'completedIntegratorStepNotNeeded="true"/>'
)

REFUSALS = {
    "the FMU is of the unknown FMI version '4.0'": [('"2.0"', '"4.0"')],
    "it does not declare its fmiVersion": [('fmiVersion="2.0"', "")],
    "there is neither <CoSimulation> nor <ModelExchange>": [(CO_SIMULATION, ""), (MODEL_EXCHANGE, "")],
    "the FMU is for scheduled execution only, which is not supported": [
        (CO_SIMULATION, '<ScheduledExecution modelIdentifier="m"/>'),
        (MODEL_EXCHANGE, ""),
    ],
    "'../../m' is not a modelIdentifier": [('Identifier="m"', 'Identifier="../../m"')],
    "there is no modelIdentifier": [('modelIdentifier="m"', "")],
    "<CoSimulation>: 'canInterpolateInputs' is 'yes', not true or false": [('Inputs="1"', 'Inputs="yes"')],
    "there is no guid": [('guid="{g}"', "")],
    "<BaseUnit>: 'm' is 'one', not a whole number": [('m="1"', 'm="one"')],
    "<BaseUnit>: the factor cannot be 0": [('factor="0.2777777777777778"', 'factor="0"')],
    "unit 'km/h' is there twice, with different meanings": [('<Unit name="degC">', '<Unit name="km/h">')],
    "type 'Speed' is there twice, with different meanings": [
        ("</TypeDefinitions>", '<SimpleType name="Speed"><Real/></SimpleType></TypeDefinitions>')
    ],
    "two items of an enumeration have the value -1": [('name="D" value="4"', 'name="D" value="-1"')],
    "item 'D' of an enumeration has no value": [('name="D" value="4"', 'name="D"')],
    "item 'P' of an enumeration is there twice": [('Item name="D"', 'Item name="P"')],
    "<DefaultExperiment>: 'stopTime' cannot be inf": [('stopTime="5"', 'stopTime="INF"')],
    "<DefaultExperiment>: 'tolerance' cannot be -1": [('tolerance="1e-5"', 'tolerance="-1"')],
    "variable 'u' is there twice": [('name="v"', 'name="u"')],
    "<ScalarVariable> has no 'name'": [('name="u" ', "")],
    "variable 'u' has no value reference": [('name="u" valueReference="1"', 'name="u"')],
    "<ScalarVariable>: 'valueReference' is '-1', not at least 0": [
        ('"u" valueReference="1"', '"u" valueReference="-1"')
    ],
    "<ScalarVariable>: 'valueReference' is '4294967296', not at most 4294967295": [
        ('"u" valueReference="1"', '"u" valueReference="4294967296"')
    ],
    "<ScalarVariable>: 'causality' cannot be 'in'": [('"1" causality="input"', '"1" causality="in"')],
    "<ScalarVariable>: 'variability' cannot be 'often'": [('variability="tunable"', 'variability="often"')],
    "variable 'u' is constant and input, which excludes each other": [
        ('causality="input"><Real start="0"/>', 'causality="input" variability="constant"><Real start="0"/>')
    ],
    "variable 'u': the start value '0,5' is not a number": [('<Real start="0"/>', '<Real start="0,5"/>')],
    "variable 'u': the start value '' is not a number": [('<Real start="0"/>', '<Real start=""/>')],
    "variable 'gear': the start value '2147483648' is not from -2147483648 to 2147483647": [
        ('start="4"', 'start="2147483648"')
    ],
    "variable 'w': the start value 'yes' is not true or false": [('<Boolean start="1"/>', '<Boolean start="yes"/>')],
    "variable 'u': the start value '0 1' is not a number": [('<Real start="0"/>', '<Real start="0 1"/>')],
    "variable 'file' has no type of FMI 2.0": [('<String start=" a b.txt"/>', "<Text/>")],
}


AT_THE_ROOT = ("version", "fmiVersion", "neither", "scheduled")


@pytest.mark.parametrize("message", REFUSALS)
def test_what_is_missing_or_contradictory_is_told_by_line(described, message):
    text, line = TEXT, 0
    for old, new in REFUSALS[message]:
        line = text[: text.index(old)].count("\n") + 1
        text = text.replace(old, new, 1)
    line = 2 if any(word in message for word in AT_THE_ROOT) else line
    assert described.problems(text) == [f"{line}: {message}"]


def test_a_constant_parameter_is_a_constant(described):
    k = described(TEXT.replace('"tunable"', '"constant"')).variables["k"]
    assert (k.causality, k.variability) == ("local", "constant")


@pytest.mark.parametrize("kinds", ["dependent", "dependent dependent dependent"])
def test_lists_of_dependencies_that_do_not_fit_together_say_nothing(described, kinds):
    found = described(TEXT.replace('"dependent constant"', f'"{kinds}"'))
    assert found.depends == {}
    assert found.initially_depends == {"v": ("u", "k"), "w": ()}


def test_states_without_derivatives_are_told_for_model_exchange_only(described):
    text = TEXT.replace('derivative="3"', "")
    assert described(text).interface is FmiInterface.CO_SIMULATION
    assert described.problems(text, FmiInterface.MODEL_EXCHANGE) == [
        "22: 'der(x)' is listed as a derivative, but its 'derivative' names no state"
    ]
    text = TEXT.replace('derivative="3"', 'derivative="8"')
    assert described.problems(text, FmiInterface.MODEL_EXCHANGE) == [
        "22: 'der(x)' and its state 'n' are no real numbers"
    ]
    text = TEXT.replace('numberOfEventIndicators="2"', 'numberOfEventIndicators="-2"')
    assert described.problems(text, FmiInterface.MODEL_EXCHANGE) == [
        "2: <fmiModelDescription>: 'numberOfEventIndicators' is '-2', not at least 0"
    ]


def test_two_inputs_of_one_reference_are_two_names_of_one(described):
    text = TEXT.replace('name="x" valueReference="3"', 'name="x" valueReference="2"')
    assert (described(text).variables["x"].reference, described(text).variables["x"].alias_of) == (2, "")
    variables = described(TEXT.replace('"x" valueReference="3"', '"x" valueReference="1" causality="input"')).variables
    # The reference of gear is 0 among the Integers, so it is no name of u.
    assert [name for name, one in variables.items() if one.alias_of] == ["x"]
    assert variables["x"].alias_of == "u"


# What changes no value is no reason to refuse an FMU.
USELESS_TYPES = {
    "not defined": ('declaredType="Speed"', 'declaredType="Spede"'),
    "of another kind": ('declaredType="Speed"', 'declaredType="Gear"'),
}


@pytest.mark.parametrize("fault", USELESS_TYPES)
def test_a_declared_type_that_cannot_be_meant_adds_nothing(described, fault):
    v = described(TEXT.replace(*USELESS_TYPES[fault])).variables["v"]
    assert (v.unit, v.minimum, v.maximum, v.nominal) == ("", None, 90, None)


def test_an_enumeration_without_a_known_type_has_no_items(described):
    for replacement in ('start="4"', 'declaredType="Gera" start="4"', 'declaredType="Speed" start="4"'):
        gear = described(TEXT.replace('declaredType="Gear" start="4"', replacement)).variables["gear"]
        assert (gear.kind, gear.items, gear.start) == (Kind.ENUMERATION, {}, ("4",))


def test_limits_that_no_value_lies_between_are_none(described):
    v = described(TEXT.replace('max="90"', 'max="-1"')).variables["v"]
    assert (v.minimum, v.maximum, v.unit, v.nominal) == (None, None, "km/h", 100)


def test_a_definition_may_be_repeated(described):
    unit = '<Unit name="km/h"><BaseUnit m="1" s="-1" factor="0.2777777777777778"/></Unit>'
    kind = '<SimpleType name="Speed"><Real unit="km/h" min="0" max="200" nominal="100"/></SimpleType>'
    assert TEXT.count(unit) == TEXT.count(kind) == 1
    twice = described(TEXT.replace(unit, unit + unit).replace(kind, kind + kind))
    assert twice.units == described(TEXT).units
    assert twice.variables == described(TEXT).variables


UNRELIABLE = {
    "an unknown at no variable": ('index="2" dependencies="1 3"', 'index="10" dependencies="1 3"'),
    "an unknown without an index": ('index="2" dependencies="1 3"', 'dependencies="1 3"'),
    "a dependency on no variable": ('"1 3"', '"1 33"'),
    "a dependency that is no index": ('"1 3"', '"1 x"'),
    "two different things of one output": ('<Unknown index="9"/>', '<Unknown index="2"/>'),
}


@pytest.mark.parametrize("fault", UNRELIABLE)
def test_an_output_of_which_nothing_reliable_is_said_may_depend_on_everything(described, fault):
    assert described(TEXT).depends == {"v": ("u",)}
    found = described(TEXT.replace(*UNRELIABLE[fault], 1))
    assert found.depends == {}
    assert found.initially_depends == described(TEXT).initially_depends


def test_numbers_without_end_may_be_spelled_as_programs_do(described):
    for text in ("inf", "Infinity", "INF", "+inf"):
        x = described(TEXT.replace('start="2.5"', f'start="2.5" max="{text}"')).variables["x"]
        assert x.maximum == float("inf")


def test_an_interface_that_is_not_there_is_refused_if_it_is_asked_for(described):
    assert described.problems(TEXT.replace(MODEL_EXCHANGE, ""), FmiInterface.MODEL_EXCHANGE) == [
        "2: the FMU is not for model exchange, only for co-simulation"
    ]


def test_a_step_or_tolerance_of_zero_says_nothing(described):
    text = TEXT.replace('stepSize="0.002" tolerance="1e-5"', 'stepSize="0" tolerance="0.0"')
    found = described(text)
    assert (found.experiment, found.fixed_step) == (Experiment(1, 5), None)


def test_everything_that_is_wrong_is_told_at_once_and_a_flood_is_counted(described):
    text = TEXT.replace('guid="{g}"', "").replace('name="v"', 'name="u"').replace('m="1"', 'm="one"')
    assert len(described.problems(text)) == 3
    many = "".join(f'<ScalarVariable name="a{n}"><Real/></ScalarVariable>\n' for n in range(1000))
    told = described.problems(TEXT.replace("</ModelVariables>", f"{many}</ModelVariables>"))
    assert told[0] == "0: 1000 problems, of which these are the first 20"
    assert len(told) == 21


def test_source_files_are_listed(described):
    text = TEXT.replace(
        CO_SIMULATION, f'{CO_SIMULATION[:-2]}><SourceFiles><File name="a.c"/></SourceFiles></CoSimulation>'
    )
    assert described(text).source_files == ("a.c",)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("<a/>", "1: it does not describe an FMU: its root is <a>, not <fmiModelDescription>"),
        ("<fmiModelDescription>", "1: not XML: no element found"),
        (
            '<!DOCTYPE a [<!ENTITY b "b">]><a/>',
            "1: it declares a document type or entities, which is refused as unsafe",
        ),
    ],
)
def test_what_is_no_description_is_told(described, text, told):
    assert described.problems(text) == [told]


def test_a_folder_without_a_description_is_no_fmu(tmp_path):
    with pytest.raises(DseError, match=r"^m\.fmu: there is no modelDescription\.xml in it, so it is not an FMU"):
        read_description(tmp_path, "m.fmu")
