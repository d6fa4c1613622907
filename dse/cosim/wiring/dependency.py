"""In which order values can be carried through a system: direct dependencies, strong components, tearing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError
from itertools import chain
from typing import TypeVar

from dse.cosim.wiring.border import Border, ElementPort
from dse.cosim.wiring.wiring import Wiring
from dse.graphs import components

_NAMED = 8

Node = TypeVar("Node", ElementPort, int)


@dataclass(frozen=True, slots=True)
class Write:
    """Give the element these inputs."""

    element: int
    ports: tuple[ElementPort, ...]


@dataclass(frozen=True, slots=True)
class Read:
    """Take these outputs from the element."""

    element: int
    ports: tuple[ElementPort, ...]


@dataclass(frozen=True, slots=True)
class AlgebraicLoop:
    """Outputs that depend on each other.

    If the outputs *reals* and *others* are known, *sweep* computes every value of the loop, these among them: the
    fixed points of that map are the loop's solutions. *reals* are continuous numbers; *wires* names the connections,
    ``a.y -> b.u``, in order.
    """

    reals: tuple[ElementPort, ...]
    others: tuple[ElementPort, ...]
    sweep: tuple[Read | Write, ...]
    wires: tuple[str, ...]

    @property
    def described(self) -> str:
        """The wires in words, not all of them if there are many."""
        rest = len(self.wires) - _NAMED
        return ", ".join(self.wires[:_NAMED]) + (f" and {rest} more wires" if rest > 0 else "")


Step = Read | Write | AlgebraicLoop


def order_of(wiring: Wiring, *, initially: bool, told: bool = True) -> tuple[Step, ...]:
    """Reads and writes that carry every value along all wires once, each after what it depends on.

    Takes the dependencies of the initialization, or those between steps; an output whose FMU does not tell them, or of
    any FMU if what they tell is not asked, depends on all inputs of its element. Values that depend on each other are
    one :class:`AlgebraicLoop`.
    """
    border = Border(wiring)
    graph = _graph(border, wiring, initially=initially, told=told)
    steps: list[Step] = []
    waiting: _Waiting = {}
    for generation in _components(graph):
        single = [component[0] for component in generation if len(component) == 1]
        steps += _moves(single, waiting)
        for component in sorted(component for component in generation if len(component) > 1):
            steps += _flush({port.element for port in component}, waiting)
            loop = _loop(border, _within(graph, component))
            if initially:
                # What the FMUs themselves start with is where the search for a solution begins.
                steps += _moves((*loop.reals, *loop.others), {})
            steps.append(loop)
    return (*steps, *_flush(sorted(waiting), waiting))


def doubtful_reads(wiring: Wiring) -> tuple[Read, ...]:
    """Wired outputs that may be read before all inputs of their element are there, because their FMU says so.

    They are not right in the initialization if it says what is not true.
    """
    border = Border(wiring)
    wired = _wired(border)
    found = []
    for e, element in enumerate(wiring.system.elements):
        inputs = {border.variable(port).name for port in border.inputs[e]}
        told = element.model.initially_depends
        names = {port: border.variable(port).name for port in border.outputs[e] if port in wired}
        doubtful = (
            port for port, name in names.items() if name not in inputs and not inputs <= set(told.get(name, inputs))
        )
        if ports := tuple(doubtful):
            found.append(Read(e, ports))
    return tuple(found)


Graph = Mapping[ElementPort, Sequence[ElementPort]]
"""What depends on each port directly."""

_Waiting = dict[int, list[ElementPort]]
"""Inputs that are not yet given to each element."""


def _wired(border: Border) -> set[ElementPort]:
    return {source for sources in border.sources.values() for source in sources}


def _graph(border: Border, wiring: Wiring, *, initially: bool, told: bool) -> Graph:
    wired = _wired(border)
    graph: dict[ElementPort, list[ElementPort]] = {}
    for e, element in enumerate(wiring.system.elements):
        model = element.model
        depends = (model.initially_depends if initially else model.depends) if told else {}
        inputs = {
            border.variable(port).name: port for port in border.inputs[e] if initially or not border.is_clocked(port)
        }
        graph |= {port: [] for port in inputs.values()}
        for output in border.outputs[e]:
            if output not in wired if initially else border.is_clocked(output):
                continue  # nobody waits for it yet, or clocks see to it
            graph[output] = []
            # An input that is read back, for those of its values that no wire ends at, depends on nothing.
            name = border.variable(output).name
            names = () if name in inputs else depends.get(name, tuple(inputs))
            for name in dict.fromkeys(name for name in names if name in inputs):
                graph[inputs[name]].append(output)
    for port, sources in border.sources.items():
        for source in sources if port in graph else ():
            if source in graph:
                graph[source].append(port)
    return graph


def _within(graph: Graph, ports: Collection[ElementPort]) -> dict[ElementPort, list[ElementPort]]:
    kept = set(ports)
    return {port: [after for after in graph[port] if after in kept] for port in sorted(kept)}


def _generations(graph: Mapping[Node, Sequence[Node]]) -> Iterator[tuple[Node, ...]]:
    """Nodes by how many others they come after at most; CycleError at the end if some come after themselves."""
    # Inputs of an element often have the same outputs after them, which wait for the last of these: one count for all.
    alike: dict[tuple[Node, ...], int] = {}
    sets = {node: alike.setdefault(tuple(afters), len(alike)) for node, afters in graph.items()}
    followers = list(alike)
    waiting, left = Counter(chain.from_iterable(followers)), Counter(sets.values())
    done, ready = 0, tuple(node for node in graph if node not in waiting)
    while ready:
        yield ready
        done += len(ready)
        following: list[Node] = []
        for number in map(sets.__getitem__, ready):
            left[number] -= 1
            for after in () if left[number] else followers[number]:
                waiting[after] -= 1
                if not waiting[after]:
                    following.append(after)
        ready = tuple(following)
    if done < len(graph):
        raise CycleError("some nodes come after themselves")


def _components(graph: Graph) -> list[list[list[ElementPort]]]:
    """Strong components, each sorted, by how many others they come after at most."""
    try:
        return [[[port] for port in generation] for generation in _generations(graph)]
    except CycleError:
        found = _strong(graph)
    number = {port: n for n, component in enumerate(found) for port in component}
    condensed = {
        n: sorted({number[after] for port in component for after in graph[port]} - {n})
        for n, component in enumerate(found)
    }
    return [[found[n] for n in generation] for generation in _generations(condensed)]


def _cycles(graph: Graph) -> list[list[ElementPort]]:
    return sorted(component for component in _strong(graph) if len(component) > 1)


def _strong(graph: Graph) -> list[list[ElementPort]]:
    """Strong components, each sorted."""
    ports = sorted(graph)
    number = {port: n for n, port in enumerate(ports)}
    # Outputs of an element often depend on all its inputs: one more node stands for what follows from them alike.
    hubs: dict[tuple[int, ...], int] = {}
    needs: list[Sequence[int]] = []
    for port in ports:
        afters = tuple(number[after] for after in graph[port])
        needs.append(afters if len(afters) < 2 else (hubs.setdefault(afters, len(ports) + len(hubs)),))
    found = ([n for n in component if n < len(ports)] for component in components([*needs, *hubs]))
    return [[ports[n] for n in component] for component in found if component]


def _moves(ports: Iterable[ElementPort], waiting: _Waiting) -> Iterator[Read | Write]:
    """Read the outputs among *ports* after their elements got what is *waiting* for them; inputs wait."""
    reads: dict[int, list[ElementPort]] = {}
    for port in sorted(ports):
        if port.is_output:
            reads.setdefault(port.element, []).append(port)
        else:
            waiting.setdefault(port.element, []).append(port)
    for element, outputs in reads.items():
        yield from _flush([element], waiting)
        yield Read(element, tuple(outputs))


def _flush(elements: Collection[int], waiting: _Waiting) -> Iterator[Write]:
    for element in sorted(elements):
        if ports := waiting.pop(element, None):
            yield Write(element, tuple(sorted(ports)))


def _loop(border: Border, graph: dict[ElementPort, list[ElementPort]]) -> AlgebraicLoop:
    wires = tuple(
        f"{border.label(source)} -> {border.label(target)}"
        for source in graph
        if source.is_output
        for target in sorted(graph[source])
    )
    torn = {port for port in graph if port.is_output and not border.is_real(port)}
    rest: dict[ElementPort, list[ElementPort]] = {port: [] if port in torn else after for port, after in graph.items()}
    cycles = _cycles(rest)
    while cycles:
        # The output that is on most paths of the component: few unknowns, and always the same ones.
        part = _within(rest, cycles.pop())
        befores = Counter(after for afters in part.values() for after in afters)
        outputs = [port for port in part if port.is_output]
        best = max(outputs, key=lambda port: (befores[port] * len(part[port]), -border.variable(port).size))
        torn.add(best)
        rest[best] = part[best] = []
        cycles += _cycles(part)
    sweep: list[Read | Write] = []
    waiting: _Waiting = {}
    for generation in _generations(rest):
        sweep += _moves(generation, waiting)
    sweep += _flush(sorted(waiting), waiting)
    return AlgebraicLoop(
        tuple(sorted(port for port in torn if border.is_real(port))),
        tuple(sorted(port for port in torn if not border.is_real(port))),
        tuple(sweep),
        wires,
    )
