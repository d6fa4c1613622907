"""In which order values can be carried through a system: direct dependencies, strong components, tearing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from dse.cosim.wiring.border import Border, Port
from dse.cosim.wiring.wiring import Wiring

_NAMED = 8


@dataclass(frozen=True, slots=True)
class Write:
    """Give the element its inputs with these places."""

    element: int
    places: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Read:
    """Take from the element its outputs with these places."""

    element: int
    places: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Loop:
    """Outputs that depend on each other.

    If the outputs *reals* and *others* are known, *walk* computes every value of the loop, these among them: the
    fixed points of that map are the loop's solutions. *reals* are continuous numbers; *wires* names the connections,
    ``a.y -> b.u``, in order.
    """

    reals: tuple[Port, ...]
    others: tuple[Port, ...]
    walk: tuple[Read | Write, ...]
    wires: tuple[str, ...]

    @property
    def described(self) -> str:
        """The wires in words, not all of them if there are many."""
        rest = len(self.wires) - _NAMED
        return ", ".join(self.wires[:_NAMED]) + (f" and {rest} more wires" if rest > 0 else "")


Step = Read | Write | Loop


def order_of(wiring: Wiring, *, initially: bool, told: bool = True) -> tuple[Step, ...]:
    """Reads and writes that carry every value along all wires once, each after what it depends on.

    Takes the dependencies of the initialization, or those between steps; an output whose FMU does not tell them, or of
    any FMU if what they tell is not asked, depends on all inputs of its element. Values that depend on each other are
    one :class:`Loop`.
    """
    border = Border(wiring)
    graph = _graph(border, wiring, initially=initially, told=told)
    steps: list[Step] = []
    waiting: dict[int, set[int]] = {}
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
        inputs = {variable.name for variable in border.inputs[e]}
        told = element.model.initially_depends
        places = tuple(
            place
            for place, variable in enumerate(border.outputs[e])
            if Port(e, True, place) in wired
            and variable.name not in inputs
            and not inputs <= set(told.get(variable.name, inputs))
        )
        if places:
            found.append(Read(e, places))
    return tuple(found)


Graph = Mapping[Port, Sequence[Port]]
"""What depends on each port directly."""


def _wired(border: Border) -> set[Port]:
    return {source for sources in border.sources.values() for source in sources}


def _graph(border: Border, wiring: Wiring, *, initially: bool, told: bool) -> Graph:
    wired = _wired(border)
    graph: dict[Port, list[Port]] = {}
    for e, element in enumerate(wiring.system.elements):
        model = element.model
        depends = (model.initially_depends if initially else model.depends) if told else {}
        inputs = {variable.name: Port(e, False, place) for place, variable in enumerate(border.inputs[e])}
        graph |= {port: [] for port in inputs.values()}
        for place, variable in enumerate(border.outputs[e]):
            output = Port(e, True, place)
            if initially and output not in wired:
                continue  # nobody waits for it yet
            graph[output] = []
            # An input that is read back, for those of its values that no wire ends at, depends on nothing.
            names = () if variable.name in inputs else depends.get(variable.name, tuple(inputs))
            for name in dict.fromkeys(name for name in names if name in inputs):
                graph[inputs[name]].append(output)
    for port, sources in border.sources.items():
        for source in sources:
            graph[source].append(port)
    return graph


def _within(graph: Graph, ports: Collection[Port]) -> dict[Port, list[Port]]:
    kept = set(ports)
    return {port: [after for after in graph[port] if after in kept] for port in sorted(kept)}


def _generations(graph: Graph) -> list[list[Port]]:
    """Ports by how many others they come after at most; those on and behind cycles are left out."""
    missing = Counter(after for afters in graph.values() for after in afters)
    generations = []
    ready = [port for port in graph if not missing[port]]
    while ready:
        generations.append(ready)
        after: list[Port] = []
        for port in ready:
            for follower in graph[port]:
                missing[follower] -= 1
                if not missing[follower]:
                    after.append(follower)
        ready = after
    return generations


def _components(graph: Graph) -> list[list[list[Port]]]:
    """Strong components, each sorted, by how many others they come after at most."""
    generations = _generations(graph)
    if sum(map(len, generations)) == len(graph):
        return [[[port] for port in generation] for generation in generations]
    import networkx as nx  # late: most systems of components that tell their dependencies do without

    condensed = nx.condensation(nx.DiGraph(graph))
    return [
        [sorted(condensed.nodes[number]["members"]) for number in generation]
        for generation in nx.topological_generations(condensed)
    ]


def _cycles(graph: Graph) -> list[list[Port]]:
    import networkx as nx

    return sorted(sorted(part) for part in nx.strongly_connected_components(nx.DiGraph(graph)) if len(part) > 1)


def _moves(ports: Iterable[Port], waiting: dict[int, set[int]]) -> Iterator[Read | Write]:
    """Read the outputs among *ports* after their elements got what is *waiting* for them; inputs wait."""
    reads: dict[int, list[int]] = {}
    for port in sorted(ports):
        if port.is_output:
            reads.setdefault(port.element, []).append(port.place)
        else:
            waiting.setdefault(port.element, set()).add(port.place)
    for element, places in reads.items():
        yield from _flush([element], waiting)
        yield Read(element, tuple(places))


def _flush(elements: Collection[int], waiting: dict[int, set[int]]) -> Iterator[Write]:
    for element in sorted(elements):
        if places := waiting.pop(element, None):
            yield Write(element, tuple(sorted(places)))


def _loop(border: Border, graph: dict[Port, list[Port]]) -> Loop:
    wires = tuple(
        f"{border.label(source)} -> {border.label(target)}"
        for source in graph
        if source.is_output
        for target in sorted(graph[source])
    )
    torn = {port for port in graph if port.is_output and not border.is_real(port)}
    rest: dict[Port, list[Port]] = {port: [] if port in torn else after for port, after in graph.items()}
    while cycles := _cycles(rest):
        # The output that is on most paths, in the first component: few unknowns, and always the same ones.
        part = _within(rest, cycles[0])
        befores = Counter(after for afters in part.values() for after in afters)
        outputs = [port for port in part if port.is_output]
        best = max(outputs, key=lambda port: (befores[port] * len(part[port]), -border.variable(port).size))
        torn.add(best)
        rest[best] = []
    walk: list[Read | Write] = []
    waiting: dict[int, set[int]] = {}
    for generation in _generations(rest):
        walk += _moves(generation, waiting)
    walk += _flush(sorted(waiting), waiting)
    return Loop(
        tuple(sorted(port for port in torn if border.is_real(port))),
        tuple(sorted(port for port in torn if not border.is_real(port))),
        tuple(walk),
        wires,
    )
