"""The interfaces an FMU of FMI 2.0 or 3.0 offers, and what it says it can do in each."""

from __future__ import annotations

import re
from dataclasses import dataclass

from dse.domain.fmu import Capabilities, Experiment, FmiInterface
from dse.errors import DseError, Problem, fail
from dse.formats.xml import XmlElement
from dse.formats.xml_values import shortened

_NEEDS_TOOL = "needsExecutionTool"
_IN_WORDS = {FmiInterface.CO_SIMULATION: "co-simulation", FmiInterface.MODEL_EXCHANGE: "model exchange"}


@dataclass(frozen=True, slots=True)
class Offered:
    """One interface: *element* is its own, *identifier* names its library; *fixed_step* as in FmuModel."""

    interface: FmiInterface
    element: XmlElement
    identifier: str
    capabilities: Capabilities
    fixed_step: float | None = None
    needs_completed_step: bool = True


def choose_interface(
    root: XmlElement, version: int, wanted: FmiInterface | None, experiment: Experiment, problems: list[Problem]
) -> Offered:
    """The interface *wanted*, or else co-simulation before model exchange; those that need no other tool come first.

    Raises DseError if there is none; what is wrong with the one taken goes to *problems*.
    """
    there = [(kind, element) for kind in FmiInterface for element in root.all(kind)]
    possible = [pair for pair in there if wanted in (None, pair[0])]
    if not possible:
        raise _nothing_of_use(root, wanted, [kind for kind, _ in there])
    # Whether the tool is there shows when the FMU is instantiated: what wraps Python code says that it needs Python.
    kind, element = min(possible, key=lambda pair: pair[1].flag(_NEEDS_TOOL, problems))
    identifier = read_identifier(element, problems)
    if kind is FmiInterface.MODEL_EXCHANGE:
        return Offered(
            interface=kind,
            element=element,
            identifier=identifier,
            capabilities=_in_model_exchange(element, version, problems),
            needs_completed_step=_needs_completed_step(element, version, problems),
        )
    capabilities = _in_co_simulation(element, version, problems)
    internal = _positive(element, "fixedInternalStepSize", problems)
    return Offered(
        interface=kind,
        element=element,
        identifier=identifier,
        capabilities=capabilities,
        fixed_step=None if capabilities.can_handle_variable_step else internal or experiment.step,
    )


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


def _in_co_simulation(element: XmlElement, version: int, problems: list[Problem]) -> Capabilities:
    def says(name: str) -> bool:
        return element.flag(name, problems)

    if version == 2:
        return Capabilities(
            can_handle_variable_step=says("canHandleVariableCommunicationStepSize"),
            can_save_state=says("canGetAndSetFMUstate"),
            can_interpolate_inputs=says("canInterpolateInputs"),
            # Spelled like this in the standard.
            can_run_asynchronously=says("canRunAsynchronuously"),
            provides_directional_derivatives=says("providesDirectionalDerivative"),
            once_per_process=says("canBeInstantiatedOnlyOncePerProcess"),
            needs_tool=says(_NEEDS_TOOL),
        )
    return Capabilities(
        can_handle_variable_step=says("canHandleVariableCommunicationStepSize"),
        can_save_state=says("canGetAndSetFMUState"),
        has_event_mode=says("hasEventMode"),
        can_return_early=says("mightReturnEarlyFromDoStep"),
        provides_intermediate_update=says("providesIntermediateUpdate"),
        provides_directional_derivatives=says("providesDirectionalDerivatives"),
        once_per_process=says("canBeInstantiatedOnlyOncePerProcess"),
        needs_tool=says(_NEEDS_TOOL),
    )


def _in_model_exchange(element: XmlElement, version: int, problems: list[Problem]) -> Capabilities:
    state, derivative = (
        ("canGetAndSetFMUstate", "providesDirectionalDerivative")
        if version == 2
        else ("canGetAndSetFMUState", "providesDirectionalDerivatives")
    )
    return Capabilities(
        can_handle_variable_step=True,
        can_save_state=element.flag(state, problems),
        provides_directional_derivatives=element.flag(derivative, problems),
        once_per_process=element.flag("canBeInstantiatedOnlyOncePerProcess", problems),
        needs_tool=element.flag(_NEEDS_TOOL, problems),
    )


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
