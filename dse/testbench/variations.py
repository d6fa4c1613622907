"""The runs that are compared with a run to tell how exact it is, and the metrics of which they cannot tell."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from dse.domain.bench import Simulation, is_multiple
from dse.domain.facts import FmuFacts, FmuNumerics, Lever, Question
from dse.domain.fmu import FmuModel
from dse.domain.method import BONDS, Method
from dse.domain.system import Element, SystemStructure
from dse.metrics import MetricProgram

SAFETY = 1.25
"""Times the error that a change stands for is the error bar: what the grid convergence index takes (P. J. Roache,
Perspective: a method for uniform reporting of grid refinement studies, 1994)."""
_THIRD = 1.0 / 3.0
_SHORTER = 0.5, _THIRD
"""Of the step. What repeats with the step may repeat with half of it, too; a third of it shows that. All rows of the
bench stay rows: a step that moved them (1/sqrt(2) was tried) also moves what happens at a row, a step of an input or a
sample, by up to its length, which is no error of the run. On `acc_gains` error bars became 55 times as wide by that."""
_SETTLING = 2.0 * SAFETY
"""The same where inner numerics are made finer until what is left to change is no more than what has changed."""


@dataclass(frozen=True, slots=True)
class Variation:
    """A run of *system* by *method* whose step is the bench's times *step*; *what* it does otherwise, in words.

    The error is about *errors* times what this changes; 0 if it only shows whether another step changes anything.
    *cost* is how many times as long as the bench's own run it may well take.
    """

    what: str
    system: SystemStructure
    method: Method
    step: float = 1.0
    cost: float = 1.0
    errors: float = SAFETY


@dataclass(frozen=True, slots=True)
class Checks:
    """The *variations* that make error bars, and why metrics have none (*unmeasured*, by name).

    Metrics of *unless* have none, for the reason given, unless a shorter step of the whole system changes them. Those
    of *exact* come from parts without an error of their own.
    """

    variations: tuple[Variation, ...] = ()
    unmeasured: Mapping[str, str] = field(default_factory=dict)
    unless: Mapping[str, str] = field(default_factory=dict)
    exact: frozenset[str] = frozenset()


def checks_of(
    system: SystemStructure,
    simulation: Simulation,
    numerics: Mapping[str, FmuNumerics],
    exchanges: Mapping[str, FmuModel],
    facts: Mapping[str, FmuFacts],
    program: MetricProgram,
    sources: Mapping[str, str],
) -> Checks:
    """What makes the error bars of the metrics of *program*; *sources* are the system's names of its signals."""
    own = [variation] if (variation := _refined(system, simulation, numerics, exchanges)) else []
    halves = can_halve(system, simulation)
    steps = [_scaled(system, simulation, f) for f in _SHORTER if _can_scale(system, simulation, f)]
    if not steps or any(Lever.DOUBLED in known.changes for known in numerics.values()):
        steps.append(_scaled(system, simulation, 2.0))
    elif len(steps) == 1 and simulation.steps % 2 == 0:
        steps.append(replace(_scaled(system, simulation, 2.0), errors=0.0))
    variations = (*steps, *own)
    if why := _not_again(system, facts, needs_more=any(not shares(v, system, simulation) for v in variations)):
        return Checks((), dict.fromkeys(program.metrics, why))
    unknown = {name: known.unknown for name, known in numerics.items() if known.unknown}
    if any(variation.step > 1.0 and simulation.steps % 2 for variation in steps):
        longer = "shows its error in longer steps only, and the bench makes an odd number"
        unknown |= {name: longer for name, known in numerics.items() if Lever.DOUBLED in known.changes}
        variations = tuple(variation for variation in variations if variation.step <= 1.0)
    unmeasured: dict[str, str] = {}
    unless: dict[str, str] = {}
    exact: set[str] = set()
    for metric in program.metrics:
        reach = _upstream(system, _elements(program.signals_of(metric), sources, system, simulation.method))
        if doubtful := [name for name in unknown if name in reach]:
            coupled = halves and all(numerics[name].shows_coupled for name in doubtful)
            of = system.element(doubtful[0]).model.identifier
            (unless if coupled else unmeasured)[metric] = f"{doubtful[0]} ({of}): {unknown[doubtful[0]]}"
        elif all(numerics[name].exact for name in reach):
            exact.add(metric)
    return Checks(variations if len(unmeasured) < len(program.metrics) else (), unmeasured, unless, frozenset(exact))


def shares(variation: Variation, system: SystemStructure, simulation: Simulation) -> bool:
    """Whether the instances that make the runs themselves can make those of *variation*, too."""
    return variation.system is system and variation.method == simulation.method


def can_halve(system: SystemStructure, simulation: Simulation) -> bool:
    """Whether all elements of *system* bear half of their steps."""
    return _can_scale(system, simulation, 0.5)


def _can_scale(system: SystemStructure, simulation: Simulation, factor: float) -> bool:
    return all(
        element.model.fixed_step is None
        or is_multiple(_step_of(element, simulation) * factor, element.model.fixed_step)
        for element in system.elements
    )


def scaled(method: Method, factor: float) -> Method:
    """*method* with *factor* times every step that parts have of their own.

    Adaptive steps are what their tolerance makes of them: a quarter of it stands for half the step, as the error of a
    step goes with its square.
    """
    adaptive = method.adaptive
    if adaptive is not None:
        square = factor**2
        adaptive = replace(adaptive, tolerance=adaptive.tolerance * square, absolute=adaptive.absolute * square)
    return replace(method, steps={part: step * factor for part, step in method.steps.items()}, adaptive=adaptive)


def _scaled(system: SystemStructure, simulation: Simulation, factor: float) -> Variation:
    """The run with *factor* times all steps.

    With an error of c h in steps of h, twice the step changes c h and half the step c h / 2 (Richardson): inputs that
    are held are of first order, whatever computes the parts. Of a higher order the change is a larger share of the
    error.
    """
    words = {0.5: "half the step", _THIRD: "a third of the step", 2.0: "twice the step"}[factor]
    errors = SAFETY / abs(1.0 - factor)
    return Variation(f"with {words}", system, scaled(simulation.method, factor), factor, max(1.0, 1.0 / factor), errors)


def _refined(
    system: SystemStructure,
    simulation: Simulation,
    numerics: Mapping[str, FmuNumerics],
    exchanges: Mapping[str, FmuModel],
) -> Variation | None:
    """The run in which parts compute by themselves as finely as shows their errors; None if half the step does that."""
    steps = dict(simulation.method.steps)
    elements = []
    cost = 2.0 * max((known.divisor for known in numerics.values()), default=0) + 2.0  # tolerances cost some, too
    for element in system.elements:
        known, own = numerics[element.name], _step_of(element, simulation)
        if Lever.EXCHANGE in known.changes:
            elements.append(_with_tolerance(replace(element, model=exchanges[element.name]), known.tolerance))
            continue
        elements.append(_with_tolerance(element, known.tolerance) if Lever.TOLERANCE in known.changes else element)
        if known.divisor > 2:
            finer = own / known.divisor
            steps[element.name] = finer if own <= simulation.step else _fraction(simulation.step, finer)
    if steps == simulation.method.steps and all(a is b for a, b in zip(elements, system.elements, strict=True)):
        return None
    what = "with what parts do inside made finer"
    refined = replace(system, elements=tuple(elements))
    if simulation.method.adaptive is None:
        return Variation(what, refined, replace(simulation.method, steps=steps), 1.0, cost, _SETTLING)
    # Adaptive steps leave parts no steps of their own: all have to make the shortest.
    shortest = min((step / simulation.step for step in steps.values()), default=1.0)
    return Variation(what, refined, simulation.method, shortest, cost, _SETTLING)


def _with_tolerance(element: Element, tolerance: float) -> Element:
    experiment = replace(element.model.experiment, tolerance=tolerance)
    return replace(element, model=replace(element.model, experiment=experiment))


def _fraction(step: float, most: float) -> float:
    """*step* halved until it is no longer than *most*."""
    while step > most * (1.0 + 1e-9):
        step /= 2
    return step


def _step_of(element: Element, simulation: Simulation) -> float:
    return simulation.method.steps.get(element.name, simulation.step)


def _not_again(system: SystemStructure, facts: Mapping[str, FmuFacts], *, needs_more: bool) -> str:
    """Why no run can be made a second time in its process, perhaps beside the instances of the first."""
    for element in system.elements:
        known, name = facts.get(element.name), f"{element.name} ({element.model.identifier})"
        if known is not None and known.denies(Question.RENEWS):
            return f"{name}: a second instance in one process differs from the first"
        alone = element.model.capabilities.once_per_process or (known is not None and known.denies(Question.COEXISTS))
        if alone and needs_more:
            return f"{name}: it does not support a second instance in one process"
    return ""


def _elements(
    signals: Iterable[str], sources: Mapping[str, str], system: SystemStructure, method: Method
) -> Iterable[str]:
    """The elements that *signals* come from."""
    bonds = {f"{BONDS}.{bond.name}": (bond.effort, bond.flow) for bond in method.bonds}
    ends = [end for signal in signals for end in bonds.get(sources[signal], (sources[signal],))]
    return [element.name for element in system.elements if any(end.startswith(f"{element.name}.") for end in ends)]


def _upstream(system: SystemStructure, elements: Iterable[str]) -> set[str]:
    """*elements* and all that they hang on."""
    reached, waiting = set(elements), list(elements)
    while waiting:
        target = waiting.pop()
        sources = {wire.source for wire in system.wires if wire.target == target} - reached
        reached |= sources
        waiting += sources
    return reached
