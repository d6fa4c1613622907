"""The interfaces an FMU offers, and what it says it can do in each."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from dse.domain.fmu import Capabilities, Experiment, FmiInterface
from dse.errors import DseError, Problem, fail
from dse.formats import XmlElement, shortened

_NEEDS_TOOL = "needsExecutionTool"
_IN_WORDS = {FmiInterface.CO_SIMULATION: "co-simulation", FmiInterface.MODEL_EXCHANGE: "model exchange"}

_EVERY_VERSION = {
    "can_handle_variable_step": "canHandleVariableCommunicationStepSize",
    "once_per_process": "canBeInstantiatedOnlyOncePerProcess",
}
_UP_TO_2 = {
    **_EVERY_VERSION,
    "can_interpolate_inputs": "canInterpolateInputs",
    # Spelled like this in the standard.
    "can_run_asynchronously": "canRunAsynchronuously",
}
_CAPABILITIES: Mapping[int, Mapping[str, str]] = {
    1: _UP_TO_2,
    2: {
        **_UP_TO_2,
        "can_save_state": "canGetAndSetFMUstate",
        "provides_directional_derivatives": "providesDirectionalDerivative",
        "needs_tool": _NEEDS_TOOL,
    },
    3: {
        **_EVERY_VERSION,
        "can_save_state": "canGetAndSetFMUState",
        "has_event_mode": "hasEventMode",
        "evaluates_discrete_states": "providesEvaluateDiscreteStates",
        "can_return_early": "mightReturnEarlyFromDoStep",
        "provides_intermediate_update": "providesIntermediateUpdate",
        "provides_directional_derivatives": "providesDirectionalDerivatives",
        "needs_tool": _NEEDS_TOOL,
    },
}
"""The attribute behind each of `Capabilities`, by version."""


@dataclass(frozen=True, slots=True)
class ChosenInterface:
    """One interface: *element* is its own, *identifier* names its library; *fixed_step* as in FmuModel."""

    interface: FmiInterface
    element: XmlElement
    identifier: str
    capabilities: Capabilities
    fixed_step: float | None = None
    needs_completed_step: bool = True


def choose_interface(
    root: XmlElement, version: int, wanted: FmiInterface | None, experiment: Experiment, problems: list[Problem]
) -> ChosenInterface:
    """The interface *wanted*, or else co-simulation before model exchange; those that need no other tool come first.

    Raises DseError if there is none; what is wrong with the one taken goes to *problems*.
    """
    if version == 1:
        return _of_version_1(root, wanted, experiment, problems)
    there = [(kind, element) for kind in FmiInterface for element in root.all(kind)]
    possible = [pair for pair in there if wanted in (None, pair[0])]
    if not possible:
        raise _nothing_of_use(root, wanted, [kind for kind, _ in there])
    # Whether the tool is there shows when the FMU is instantiated: what wraps Python code says that it needs Python.
    kind, element = min(possible, key=lambda pair: pair[1].flag(_NEEDS_TOOL, problems))
    identifier = read_identifier(element, problems)
    capabilities = _capabilities(element, version, problems)
    if kind is FmiInterface.MODEL_EXCHANGE:
        # The solver is ours, so every step is possible.
        needs = _needs_completed_step(element, version, problems)
        capabilities = replace(capabilities, can_handle_variable_step=True)
        return ChosenInterface(kind, element, identifier, capabilities, needs_completed_step=needs)
    if version == 3 and element.flag("canReturnEarlyAfterIntermediateUpdate", problems):
        # It says that it can when it is asked to; some then do so without being asked, too.
        capabilities = replace(capabilities, can_return_early=True)
    step = _positive(element, "fixedInternalStepSize", problems) or experiment.step
    fixed_step = None if capabilities.can_handle_variable_step else step
    return ChosenInterface(kind, element, identifier, capabilities, fixed_step)


def _of_version_1(
    root: XmlElement, wanted: FmiInterface | None, experiment: Experiment, problems: list[Problem]
) -> ChosenInterface:
    if wanted is FmiInterface.MODEL_EXCHANGE:
        raise fail("model exchange of FMI 1.0 is not supported", root.where)
    implementation = root.child("Implementation")
    if implementation is None:
        what = "the FMU is for model exchange of FMI 1.0, which is not supported"
        raise fail(what, root.where, "export it for co-simulation, or for FMI 2.0 or 3.0")
    kind = next((child for child in implementation.children if child.tag.startswith("CoSimulation_")), None)
    if kind is None:
        raise fail("<Implementation> has no CoSimulation_StandAlone", implementation.where)
    told = kind.child("Capabilities")
    capabilities = Capabilities() if told is None else _capabilities(told, 1, problems)
    capabilities = replace(capabilities, needs_tool=kind.tag == "CoSimulation_Tool")
    fixed_step = None if capabilities.can_handle_variable_step else experiment.step
    return ChosenInterface(FmiInterface.CO_SIMULATION, root, read_identifier(root, problems), capabilities, fixed_step)


def _capabilities(element: XmlElement, version: int, problems: list[Problem]) -> Capabilities:
    return Capabilities(**{name: element.flag(said, problems) for name, said in _CAPABILITIES[version].items()})


def read_identifier(element: XmlElement, problems: list[Problem]) -> str:
    """The modelIdentifier, which is part of a path and of names of functions; a problem if it is none."""
    identifier = element.get("modelIdentifier").strip()
    if not re.fullmatch(r"\w[\w.\-]*", identifier) or len(identifier) > 200:
        what = f"'{shortened(identifier)}' is not a modelIdentifier" if identifier else "there is no modelIdentifier"
        problems.append(Problem(what, element.where))
    return identifier


def read_experiment(root: XmlElement, problems: list[Problem]) -> Experiment:
    """The default experiment. A step or tolerance of zero says nothing."""
    element = root.child("DefaultExperiment")
    if element is None:
        return Experiment()
    return Experiment(
        start=_finite(element, "startTime", problems),
        stop=_finite(element, "stopTime", problems),
        step=_positive(element, "stepSize", problems),
        tolerance=_positive(element, "tolerance", problems),
    )


def _nothing_of_use(root: XmlElement, wanted: FmiInterface | None, there: list[FmiInterface]) -> DseError:
    if wanted is not None and there:
        what = f"the FMU is not for {_IN_WORDS[wanted]}, only for {_IN_WORDS[there[0]]}"
        return fail(what, root.where)
    if root.child("ScheduledExecution") is not None:
        what = "the FMU is for scheduled execution only, which is not supported"
        return fail(what, root.where, "export it for co-simulation or model exchange")
    return fail("there is neither <CoSimulation> nor <ModelExchange>", root.where)


def _needs_completed_step(element: XmlElement, version: int, problems: list[Problem]) -> bool:
    if version == 2:
        return not element.flag("completedIntegratorStepNotNeeded", problems)
    return element.flag("needsCompletedIntegratorStep", problems)


def _finite(element: XmlElement, name: str, problems: list[Problem]) -> float | None:
    value = element.real(name, problems)
    if value is not None and not abs(value) < float("inf"):
        problems.append(Problem(f"<{element.tag}>: '{name}' cannot be {value:g}", element.where))
        return None
    return value


def _positive(element: XmlElement, name: str, problems: list[Problem]) -> float | None:
    value = _finite(element, name, problems)
    if value is not None and value < 0:
        problems.append(Problem(f"<{element.tag}>: '{name}' cannot be {value:g}", element.where))
    return value or None
