"""Clocks of FMI 3 co-simulation: what makes each tick, and in which order what belongs to them is carried."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import IntEnum

from dse.cosim.binding.calls import text_type_of
from dse.cosim.wiring.links import Link, clock_wires
from dse.domain.fmu import Variable
from dse.domain.system import SystemStructure, Wire
from dse.graphs import components

_WEIGHTS = 5
"""How much it matters that one step comes before another: 0 for what must, 4 for what is merely usual."""


class Act(IntEnum):
    """What is done in an instant with a clock or a variable that belongs to one; numbered as in plan.h."""

    POLL = 0
    """Ask an output clock whether it ticks."""
    TICK = 1
    """Let an input clock tick."""
    SAMPLE = 2
    """Read an output."""
    DELIVER = 3
    """Write an input."""


@dataclass(frozen=True, slots=True)
class WiredClock:
    """One clock of an element; *sources* number the clocks it ticks with, besides by itself."""

    element: int
    variable: Variable
    sources: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class ClockStep:
    """One act on a variable of an element, done while one of *clocks* ticks, or whenever there are none.

    *clock* numbers the clock that is polled or ticks. *sources* number the steps that sample what is delivered.
    *is_message*: strings and binaries are delivered in the instant in which they were sampled, and only then.
    """

    act: Act
    element: int
    variable: Variable
    clock: int = -1
    clocks: tuple[int, ...] = ()
    sources: tuple[int, ...] = ()
    is_message: bool = False


@dataclass(frozen=True, slots=True)
class ClockGroup:
    """Elements that clocks, or what belongs to clocks, go between: they stop together wherever one of them ticks.

    They step in the order of *elements*. Only *early* (-1 for none) may end a step before the others do.
    """

    elements: tuple[int, ...]
    early: int
    clocks: range
    steps: range


@dataclass(frozen=True, slots=True)
class Clocks:
    """All clocks of a system; *groups* hold ranges of *clocks* and *steps*."""

    clocks: tuple[WiredClock, ...] = ()
    steps: tuple[ClockStep, ...] = ()
    groups: tuple[ClockGroup, ...] = ()

    @property
    def elements(self) -> frozenset[int]:
        """The elements that stop where clocks tick."""
        return frozenset(e for group in self.groups for e in group.elements)

    def counted(self, system: SystemStructure) -> dict[str, tuple[bool, int]]:
        """What is counted, by ``element.variable``: ticks of a clock (True) or bytes of messages, and its number."""
        ticks = {self.label(number, system): (True, number) for number in range(len(self.clocks))}
        messages = {
            f"{system.elements[step.element].name}.{step.variable.name}": (False, number)
            for number, step in enumerate(self.steps)
            if step.act is Act.SAMPLE and step.is_message
        }
        return ticks | messages

    def label(self, number: int, system: SystemStructure) -> str:
        """``element.clock``."""
        clock = self.clocks[number]
        return f"{system.elements[clock.element].name}.{clock.variable.name}"


def clocks_of(system: SystemStructure, links: Mapping[str, Link]) -> Clocks:
    """The clocks of *system*, whose values are wired by *links*."""
    found = [
        WiredClock(e, variable)
        for e, element in enumerate(system.elements)
        if element.model.ticks
        for variable in element.model.variables.values()
        if variable.timing and not variable.alias_of and variable.causality in ("input", "output")
    ]
    if not found:
        return Clocks()
    return _Maker(system, links, found).clocks()


class _Maker:
    def __init__(self, system: SystemStructure, links: Mapping[str, Link], found: list[WiredClock]) -> None:
        self._elements = system.elements
        self._numbers = {element.name: e for e, element in enumerate(system.elements)}
        self._owners = {
            f"{element.name}.{label}": (e, variable)
            for e, element in enumerate(system.elements)
            for variable in element.outputs
            for label in variable.labels
        }
        self._links = links
        groups = self._grouped(found, [(self._ends(found, wire)) for wire in clock_wires(system)])
        # Those of a group one after another.
        order = [n for group in groups for e in group for n, clock in enumerate(found) if clock.element == e]
        self._found = [found[n] for n in order]
        self._at = {(clock.element, clock.variable.reference): n for n, clock in enumerate(self._found)}
        wired = dict.fromkeys(self._ends(self._found, wire) for wire in clock_wires(system))
        self._found = [replace(clock, sources=self._sources(n, wired)) for n, clock in enumerate(self._found)]
        self._groups = groups

    def clocks(self) -> Clocks:
        groups: list[ClockGroup] = []
        steps: list[ClockStep] = []
        clock = 0
        for elements in self._groups:
            mine = sum(found.element in elements for found in self._found)
            made = self._steps(elements, len(steps))
            span = range(clock, clock + mine)
            early = self._early(elements, span)
            ordered = tuple(sorted(elements, key=lambda e: (e != early, e)))
            groups.append(ClockGroup(ordered, early, span, range(len(steps), len(steps) + len(made))))
            steps += made
            clock += mine
        return Clocks(tuple(self._found), tuple(steps), tuple(groups))

    def _ends(self, found: list[WiredClock], wire: Wire) -> tuple[int, int]:
        """The numbers of the clocks at both ends."""
        at = {(clock.element, clock.variable.reference): n for n, clock in enumerate(found)}
        ends = ((wire.source, wire.source_variable), (wire.target, wire.target_variable))
        source, target = (
            at[self._numbers[name], self._elements[self._numbers[name]].model.variables[variable].reference]
            for name, variable in ends
        )
        return source, target

    def _grouped(self, found: list[WiredClock], wired: Iterable[tuple[int, int]]) -> list[tuple[int, ...]]:
        ticking = {clock.element for clock in found}
        near: list[list[int]] = [[] for _ in self._elements]
        pairs = [(found[source].element, found[target].element) for source, target in wired]
        pairs += [(source, e) for e, _, source, _ in self._clocked_wires()]
        for a, b in pairs:
            near[a].append(b)
            near[b].append(a)
        return sorted(tuple(sorted(part)) for part in components(near) if ticking & set(part))

    def _clocked_wires(self) -> Iterator[tuple[int, Variable, int, Variable]]:
        """Inputs that belong to clocks, and outputs that do so, too, from which they are taken."""
        for e, element in enumerate(self._elements):
            for variable in element.inputs:
                for label in variable.labels if element.model.lets_tick(variable) else ():
                    link = self._links.get(f"{element.name}.{label}")
                    if link is None or link.source not in self._owners:
                        continue
                    source, output = self._owners[link.source]
                    if self._elements[source].model.lets_tick(output):
                        yield e, variable, source, output

    def _sources(self, number: int, wired: Iterable[tuple[int, int]]) -> tuple[int, ...]:
        """The clocks that a triggered input clock ticks with.

        Without a wire of its own these are the clocks of the outputs that its variables are taken from: there is no
        other moment to carry them (FMI-LS-BUS 1.0 connects clocks that are inputs on both sides).
        """
        clock = self._found[number]
        timing = clock.variable.timing
        if clock.variable.causality != "input" or timing is None or clock.variable.is_timed:
            return ()
        told = tuple(source for source, target in wired if target == number)
        if told:
            return told
        implied = [
            self._at[source, reference]
            for e, variable, source, output in self._clocked_wires()
            if e == clock.element and clock.variable.reference in variable.clocks
            for reference in output.clocks
            if (source, reference) in self._at
        ]
        return tuple(dict.fromkeys(implied))

    def _early(self, elements: tuple[int, ...], clocks: range) -> int:
        """The one element whose output clocks others tick with: where it stops, all others can. Or the only element."""
        found = [self._found[source] for n in clocks for source in self._found[n].sources]
        telling = {clock.element for clock in found if clock.variable.causality == "output"} or set(elements)
        return telling.pop() if len(telling) == 1 else -1

    def _steps(self, elements: tuple[int, ...], first: int) -> list[ClockStep]:
        drafts = [step for e in elements for step in self._drafts(e)]
        order = _ordered(self._befores(drafts))
        at = {(drafts[n].element, drafts[n].variable.name): first + k for k, n in enumerate(order)}
        steps = [drafts[n] for n in order]
        for k, step in enumerate(steps):
            if step.act is Act.DELIVER:
                sources = [at[source, output.name] for source, output in self._given(step)]
                steps[k] = replace(step, sources=tuple(dict.fromkeys(sources)))
        return steps

    def _given(self, step: ClockStep) -> list[tuple[int, Variable]]:
        """The clocked outputs that what is delivered is taken from."""
        return [
            (source, output)
            for e, variable, source, output in self._clocked_wires()
            if (e, variable.name) == (step.element, step.variable.name)
        ]

    def _drafts(self, e: int) -> Iterator[ClockStep]:
        element = self._elements[e]
        for n, clock in enumerate(self._found):
            if clock.element == e:
                act = Act.POLL if clock.variable.causality == "output" else Act.TICK
                yield ClockStep(act, e, clock.variable, n, self._of(e, clock.variable) if act is Act.POLL else ())
        for act, variables in ((Act.SAMPLE, element.outputs), (Act.DELIVER, element.inputs)):
            for variable in variables:
                if clocks := self._of(e, variable):
                    text = text_type_of(variable, element.model.version) is not None
                    yield ClockStep(act, e, variable, clocks=clocks, is_message=text)

    def _of(self, e: int, variable: Variable) -> tuple[int, ...]:
        return tuple(self._at[e, reference] for reference in variable.clocks if (e, reference) in self._at)

    def _befores(self, steps: list[ClockStep]) -> list[set[tuple[int, int]]]:
        """For each step the others that should be done before, and how much it matters: 0 for what must be."""
        befores: list[set[tuple[int, int]]] = [set() for _ in steps]
        clocks = {step.clock: n for n, step in enumerate(steps) if step.clock >= 0}
        at = {(step.element, step.variable.name): n for n, step in enumerate(steps)}
        for n, step in enumerate(steps):
            needed = [*step.clocks, *(self._found[step.clock].sources if step.act is Act.TICK else ())]
            befores[n] |= {(clocks[clock], 0) for clock in needed if clock in clocks}
            if step.act is Act.DELIVER:
                befores[n] |= {(at[source, output.name], 0) for source, output in self._given(step)}
            if step.act not in (Act.POLL, Act.SAMPLE):
                continue
            model = self._elements[step.element].model
            told = model.depends.get(step.variable.name)
            # An FMU that evaluates its discrete states does so once an instant, when it is asked for the first value.
            weight = 2 if model.capabilities.evaluates_discrete_states else 3 if told is None else 4
            for m, other in enumerate(steps):
                if other.element == step.element and other.act in (Act.TICK, Act.DELIVER):
                    befores[n].add((m, 1 if told is not None and other.variable.name in told else weight))
        return befores


def _ordered(befores: list[set[tuple[int, int]]]) -> list[int]:
    """The numbers of steps one after another, each after what must come before, and what should as far as it goes."""
    missing = [[sum(weight == w for _, weight in before) for w in range(_WEIGHTS)] for before in befores]
    afters: list[list[tuple[int, int]]] = [[] for _ in befores]
    for n, before in enumerate(befores):
        for m, weight in before:
            afters[m].append((n, weight))
    waiting = set(range(len(befores)))
    order: list[int] = []
    while waiting:
        best = min(waiting, key=lambda n: ([count > 0 for count in missing[n]], n))
        order.append(best)
        waiting.remove(best)
        for n, weight in afters[best]:
            missing[n][weight] -= 1
    return order
