"""Whether a system can be simulated: its wires, the method, the steps, and what its FMUs were seen to bear.

An FMU nothing is known of is taken by its word.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from dse.cosim.binding.layout import kernel
from dse.cosim.wiring.check import check_system, own_steps
from dse.domain.facts import FmuFacts, Question
from dse.domain.method import Coupling, Method
from dse.domain.system import Element, SystemStructure
from dse.errors import DseError, Problem


def require_kernel() -> None:
    """DseError if the compiled kernel is not there or does not fit."""
    kernel()


def simulation_problems(
    system: SystemStructure, method: Method, facts: Mapping[str, FmuFacts], *, stop: float, step: float
) -> list[Problem]:
    """Why *system* cannot be simulated by *method* to *stop* in steps of *step* (seconds); *facts* are by element."""
    problems: list[Problem] = []
    try:
        check_system(system, method)
        own_steps(system, method, stop=stop, step=step)
    except DseError as error:
        problems += error.problems
    return [*problems, *refusals(system, method, facts)]


def refusals(system: SystemStructure, method: Method, facts: Mapping[str, FmuFacts]) -> Iterable[Problem]:
    """Why *system* must not be simulated by *method*, as its FMUs were seen not to bear it."""
    counted: dict[Path, list[str]] = {}
    for element in system.elements:
        counted.setdefault(element.model.library, []).append(element.name)
    for names in counted.values():
        known = facts.get(names[0])
        if len(names) > 1 and known is not None and (known.denies(Question.COEXISTS) or known.denies(Question.RENEWS)):
            question = Question.COEXISTS if known.denies(Question.COEXISTS) else Question.RENEWS
            yield Problem(
                f"{', '.join(names)}: {known.identifier} does not support several instances in one process: "
                f"{known.reasons.get(question, 'they disturb each other')}",
                hint="use it in one element only",
            )
    if method.adaptive is not None:
        for name, known in facts.items():
            if known.denies(Question.SAVES):
                yield Problem(
                    f"{name}: an adaptive step needs saved states, and those of {known.identifier} do not work: "
                    f"{known.reasons.get(Question.SAVES, 'outputs differ afterwards')}",
                    hint="simulate it with a fixed step",
                )
            if known.denies(Question.VARIES_STEP):
                yield Problem(
                    f"{name}: an adaptive step varies, and {known.identifier} was found not to support that: "
                    f"{known.reasons.get(Question.VARIES_STEP, 'steps of uneven length fail')}",
                    hint="simulate it with a fixed step",
                )
    if method.coupling is not Coupling.NONE:
        for element in system.elements:
            known = facts.get(element.name)
            if known is not None and known.denies(Question.FEEDS_THROUGH) and _has_to_follow(element):
                yield Problem(
                    f"{element.name}: coupling: {method.coupling.value} needs outputs that follow inputs between two "
                    f"steps, and those of {known.identifier} were seen not to, although it declares so",
                    hint="use coupling: none",
                )


def _has_to_follow(element: Element) -> bool:
    """Whether outputs depend directly on connected inputs, as the FMU tells."""
    inputs = {variable.name for variable in element.inputs}
    return any(inputs & set(element.model.depends.get(variable.name, ())) for variable in element.outputs)
