"""Whether a system can be simulated by a method, found out before any FMU is loaded."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import isfinite

from dse.cosim.clock import steps_in
from dse.cosim.wiring.border import Border
from dse.cosim.wiring.dependency import AlgebraicLoop, order_of
from dse.cosim.wiring.wiring import Wiring, wire_up
from dse.domain.method import Algorithm, Bond, Coupling, Extrapolation, Method
from dse.domain.system import Element, SystemStructure
from dse.errors import Problem, raise_if_any

_WHOLE = 1e-9  # of a ratio of two steps from a whole number: far above rounding, far below a step


@dataclass(frozen=True, slots=True)
class OwnStep:
    """An element's own step: one in *every* of the run's steps, or *parts* in one of them."""

    every: int
    parts: int


def check_system(system: SystemStructure, method: Method) -> None:
    """Nothing if *system* can be simulated by *method*, whatever the step; else DseError with every reason."""
    check_wired(wire_up(system), method)


def check_wired(wiring: Wiring, method: Method) -> None:
    """As :func:`check_system`, for a system that is wired up already."""
    system = wiring.system
    problems = [*_unknown_names(system, method), *_bad_numbers(method)]
    if method.adaptive:
        problems += _not_adaptive(wiring, method)
    if method.coupling is Coupling.PROPAGATE:
        problems += _loops(wiring)
    if method.leading:
        problems += _bad_leading(wiring, method)
    raise_if_any([*problems, *_bad_for_clocks(wiring, method), *_bad_bonds(wiring, method)])


def own_steps(system: SystemStructure, method: Method, *, stop: float, step: float) -> tuple[OwnStep, ...]:
    """Every element's own step in a run to *stop* in steps of *step* (seconds); DseError if they do not fit."""
    count = steps_in(stop, step)
    problems: list[Problem] = []
    found = []
    for element in system.elements:
        own = method.steps.get(element.name, step)
        every, parts = round(own / step), round(step / own)
        if every >= 1 and abs(own / step - every) <= _WHOLE * every:
            found.append(OwnStep(every, 1))
            if count % every:
                problems.append(
                    Problem(
                        f"{element.name}: the stop time of {stop:.10g} s is not a whole number of its steps "
                        f"of {own:.10g} s",
                        hint=f"stop at {(count // every + 1) * every * step:.10g} s",
                    )
                )
        elif parts >= 1 and abs(step / own - parts) <= _WHOLE * parts:
            found.append(OwnStep(1, parts))
        else:
            problems.append(
                Problem(
                    f"{element.name}: its step of {own:.10g} s is neither a whole multiple nor a whole fraction of "
                    f"the run's step of {step:.10g} s"
                )
            )
    raise_if_any(problems)
    return tuple(found)


def _unknown_names(system: SystemStructure, method: Method) -> Iterable[Problem]:
    names = {element.name for element in system.elements}
    for what, mapping in (("a step", method.steps), ("an extrapolation", method.extrapolations)):
        yield from (
            Problem(f"there is no element '{name}' to give {what} of its own") for name in mapping if name not in names
        )


def _bad_numbers(method: Method) -> Iterable[Problem]:
    for name, step in method.steps.items():
        if not (isfinite(step) and step > 0):
            yield Problem(f"{name}: cannot make steps of {step:g} s", hint="its step must be positive and finite")
    if method.adaptive:
        wanted = {
            "tolerance": method.adaptive.tolerance,
            "absolute tolerance": method.adaptive.absolute,
            "smallest step": method.adaptive.smallest,
        }
        for what, value in wanted.items():
            if not (isfinite(value) and value > 0):
                yield Problem(f"the {what} of an adaptive step cannot be {value:g}", hint="it must be positive")


def _not_adaptive(wiring: Wiring, method: Method) -> Iterable[Problem]:
    if not Border(wiring).real_outputs:
        yield Problem(
            "an adaptive step has nothing to be judged by: no output that is wired or recorded is a continuous real "
            "number",
            hint="record one, or use a fixed step",
        )
    if method.steps:
        yield Problem(
            f"{', '.join(sorted(method.steps))}: steps of their own do not go together with an adaptive step",
            hint="leave out one of them",
        )
    for element in wiring.system.elements:
        model = element.model
        if not model.capabilities.can_save_state:
            yield Problem(
                f"{element.name}: an adaptive step takes steps back, but {model.identifier} cannot save its state",
                hint="use a fixed step",
            )
        if not model.capabilities.can_handle_variable_step or model.fixed_step is not None:
            yield Problem(
                f"{element.name}: an adaptive step varies, but {model.identifier} takes only steps of one length",
                hint="use a fixed step",
            )


def _bad_for_clocks(wiring: Wiring, method: Method) -> Iterable[Problem]:
    names = [wiring.system.elements[e].name for e in sorted(wiring.clocks.elements)]
    if names and method.adaptive:
        what = f"{', '.join(names)}: clocks that tick do not go together with an adaptive step"
        yield Problem(what, hint="use a fixed step: where clocks tick, steps end anyway")
    for name in names if method.steps else ():
        if name in method.steps:
            yield Problem(
                f"{name}: a step of its own does not go together with clocks that tick",
                hint="leave it out: where clocks tick, steps end anyway",
            )


def _bad_leading(wiring: Wiring, method: Method) -> Iterable[Problem]:
    names = [element.name for element in wiring.system.elements]
    leading = ", ".join(method.leading)
    if tuple(names[: len(method.leading)]) != method.leading:
        yield Problem(f"{leading}: what leads is not what the system has first, {names[0]}", hint="put it there")
        return
    parts = {
        "coupling": method.coupling is not Coupling.NONE,
        "an adaptive step": method.adaptive is not None,
        "a step of its own": any(name in method.steps for name in method.leading),
        "clocks that tick": any(names[e] in method.leading for e in wiring.clocks.elements),
        "a bond": any(
            names[wiring.owners[wiring.values.index(label)]] in method.leading
            for bond in method.bonds
            for label in (bond.effort, bond.flow)
            if label in wiring.values
        ),
    }
    for what, is_there in parts.items():
        if is_there:
            yield Problem(
                f"{leading}: what leads does not go together with {what}",
                hint="what it shows between two steps is of the beginning of the last one",
            )


def _loops(wiring: Wiring) -> Iterable[Problem]:
    for step in order_of(wiring, initially=False):
        if isinstance(step, AlgebraicLoop):
            yield Problem(
                f"values cannot be propagated round an algebraic loop: {step.described}",
                hint="use coupling: solve, or FMUs that declare which outputs depend on which inputs",
            )


def _bad_bonds(wiring: Wiring, method: Method) -> Iterable[Problem]:
    seen: set[str] = set()
    for bond in method.bonds:
        if bond.name in seen:
            yield Problem(f"there are two bonds '{bond.name}'")
        seen.add(bond.name)
        unknown = [label for label in (bond.effort, bond.flow) if label not in wiring.values]
        if unknown:
            yield from (Problem(f"bond {bond.name}: there is no output '{label}'") for label in unknown)
            continue
        yield from _not_a_bond(wiring, bond)


def _not_a_bond(wiring: Wiring, bond: Bond) -> Iterable[Problem]:
    for from_label, to_label in ((bond.effort, bond.flow), (bond.flow, bond.effort)):
        position, target = wiring.values.index(from_label), wiring.owners[wiring.values.index(to_label)]
        if not wiring.group_at(position).type.is_floating:
            yield Problem(f"bond {bond.name}: {from_label} is not a real number")
        if not any(position in group.positions for group in wiring.inputs[target]):
            name = wiring.system.elements[target].name
            yield Problem(
                f"bond {bond.name}: {from_label} is not wired to {name}",
                hint="each of a bond's two outputs is an input of the other's element",
            )


def extrapolation_of(element: Element, method: Method) -> Extrapolation:
    """What the inputs of *element* do during a step."""
    return method.extrapolations.get(element.name, method.extrapolation)


def is_plain(method: Method) -> bool:
    """Whether *method* is Jacobi with one fixed step and nothing else."""
    return (
        method.algorithm is Algorithm.JACOBI
        and method.coupling is Coupling.NONE
        and {method.extrapolation, *method.extrapolations.values()} <= {Extrapolation.HOLD}
        and not (method.steps or method.adaptive or method.bonds or method.leading)
    )
