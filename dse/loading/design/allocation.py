"""Functions that are allocated to parts: ``placement: {allocate: [acc, aeb], to: ecu, load: compute}``.

An allocation is a choice of connections: each function has as many as it is to be redundant, one if nothing is said.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from dse.domain.design import Allocation, Compound, Node, Optional, Part
from dse.errors import Problem, closest, fail, raise_if_any
from dse.formats import Entry
from dse.loading.design.connection_choice import (
    ChosenStructure,
    Endpoint,
    Layout,
    Pattern,
    chosen,
    endpoints,
    excluded,
)
from dse.loading.design.repetition import Bounds, read_bounds
from dse.loading.design.scope import Scope
from dse.loading.names import check_choice
from dse.loading.sections import Plain, Section, read_section
from dse.loading.values import read_quantity


class AllocateSection(Section):
    """Which functions are allocated, to what, and what the allocation has to respect."""

    allocate: list[str] | dict[str, dict[str, Plain]]
    to: str
    load: str | list[str] = []
    capacity: str | list[str] = []
    apart: list[list[str]] = []
    together: list[list[str]] = []
    redundancy: int | dict[str, int] = {}
    incoming: str | int = "0..*"
    exclude: list[str] = []


def read_allocation(entry: Entry, parts: Mapping[str, Node], scope: Scope) -> ChosenStructure:
    """The allocation at *entry* between the *parts* of the compound at *scope*. Raises DseError."""
    section = read_section(entry, AllocateSection)
    functions = _functions(entry["allocate"], section.allocate, parts)
    hosts = endpoints(entry["to"], section.to.split(","), parts)
    for end in (*functions, *hosts):
        if end.port:
            raise fail(f"'{end.path}' has no part '{end.port}'", entry["to"].where, "an allocation is between parts")
    named = {**parts, **{end.path: end.node for end in functions if "." not in end.path}}
    all_pairs = {(i, j) for i in range(len(functions)) for j in range(len(hosts))}
    pairs = all_pairs - excluded(entry["exclude"], section.exclude, named, functions, hosts)
    copies = _redundancy(entry["redundancy"], section.redundancy, functions)
    pattern = Pattern(functions, hosts, pairs, copies, read_bounds(entry["incoming"], section.incoming))
    layout = Layout(entry.name, pattern)
    rules = {
        "load": list(_loads(entry, section, layout)),
        "apart": list(_apart(entry["apart"], section.apart, layout)),
        "together": list(_together(entry["together"], section.together, layout)),
    }
    structure = chosen(entry, layout, parts, scope, rules)
    return replace(structure, node=replace(structure.node, allocation=_allocation(entry, section, layout)))


def _allocation(entry: Entry, section: AllocateSection, layout: Layout) -> Allocation:
    sources, targets = layout.pattern.sources, layout.pattern.targets
    decisions = {(i, j): layout.place(i, j) for i, j in sorted(layout.pattern.pairs)}
    stated = section.allocate if isinstance(section.allocate, Mapping) else {}
    return Allocation(
        {end.label: end.path for end in sources},
        {end.label: end.path for end in targets},
        tuple(
            (sources[i].label, targets[j].label, path.removeprefix(f"{layout.name}."), names[0] if names else "")
            for (i, j), (path, names) in decisions.items()
        ),
        tuple(_bounds(entry, section)),
        {
            name: {load: read_quantity(raw, entry["allocate"][name][load].where) for load, raw in each.items()}
            for name, each in stated.items()
        },
    )


def _functions(entry: Entry, named: Sequence[str] | Mapping[str, object], parts: Mapping[str, Node]) -> list[Endpoint]:
    """Names of parts, or of functions that are nothing but allocated."""
    if not named:
        raise fail("nothing is allocated", entry.where, "allocate: [acc, aeb]")
    found: list[Endpoint] = []
    for step, name in enumerate(named):
        here = entry[name if isinstance(named, Mapping) else step]
        if name.partition(".")[0] in parts and not isinstance(named, Mapping):
            found += endpoints(here, [name], parts)
            continue
        problems: list[Problem] = []
        check_choice(name, here.where, problems)
        raise_if_any(problems)
        found.append(Endpoint(name, name, Compound(name, {})))
    labels = [end.label for end in found]
    for label in labels:
        if labels.count(label) > 1:
            raise fail(f"'{label}' is listed twice", entry.where, "remove one of the two")
    return found


def _redundancy(entry: Entry, stated: int | Mapping[str, int], functions: Sequence[Endpoint]) -> list[Bounds]:
    if isinstance(stated, Mapping):
        for name in stated:
            _number(entry[name], name, functions)
    copies = [stated if isinstance(stated, int) else stated.get(end.path, 1) for end in functions]
    for end, number in zip(functions, copies, strict=True):
        if number < 1:
            raise fail(f"{number} copies of '{end.path}'", entry.where, "1 or more")
    return [Bounds(number, number) for number in copies]


def _number(entry: Entry, name: str, functions: Sequence[Endpoint]) -> int:
    names = [end.path for end in functions]
    if name not in names:
        raise fail(f"'{name}' is not allocated here", entry.where, closest(name, names))
    return names.index(name)


def _loads(entry: Entry, section: AllocateSection, layout: Layout) -> Iterator[str]:
    """For every property and host: the sum over what is allocated there is at most what the host states."""
    functions, hosts = layout.pattern.sources, layout.pattern.targets
    for load, capacity in _bounds(entry, section):
        amounts = [_amount(entry, section.allocate, end, load) for end in functions]
        for j, host in enumerate(hosts):
            some = [
                f"(if {layout.connected(i, j)} then {amount} else 0)"
                for i, amount in enumerate(amounts)
                if (i, j) in layout.pattern.pairs
            ]
            if some:
                yield f"{' + '.join(some)} <= sum({capacity}, {host.path})"


def _bounds(entry: Entry, section: AllocateSection) -> Iterator[tuple[str, str]]:
    """Each load with the property that bounds it."""
    loads = [section.load] if isinstance(section.load, str) else section.load
    capacities = [section.capacity] if isinstance(section.capacity, str) else section.capacity or loads
    if len(loads) != len(capacities):
        what = f"{len(loads)} loads and {len(capacities)} capacities"
        raise fail(what, entry["capacity"].where, "one capacity for each load")
    yield from zip(loads, capacities, strict=True)


def _amount(
    entry: Entry, stated: Sequence[str] | Mapping[str, Mapping[str, str | int | float]], end: Endpoint, load: str
) -> str:
    """The *load* of a function as an expression."""
    if isinstance(stated, Mapping):
        here = entry["allocate"][end.path]
        if load not in stated[end.path]:
            raise fail(f"'{end.path}' does not state '{load}'", here.key, f"{end.path}: {{{load}: …}}")
        raw = stated[end.path][load]
        read_quantity(raw, here[load].where)
        return str(raw)
    node = end.node.content if isinstance(end.node, Optional) else end.node
    if isinstance(node, Compound) and not node.parts:
        what = f"'{end.path}' is no part, so it has no '{load}'"
        raise fail(what, entry["load"].where, f"allocate: {{{end.path}: {{{load}: …}}}}")
    if isinstance(node, Part) and load in node.component.properties:
        return node.component.properties[load].text
    return f"{end.path}.{load}"


def _apart(entry: Entry, groups: Sequence[Sequence[str]], layout: Layout) -> Iterator[str]:
    for numbers in _groups(entry, groups, layout):
        for j in range(len(layout.targets)):
            some = [layout.connected(i, j) for i in numbers if (i, j) in layout.pattern.pairs]
            if len(some) > 1:
                yield f"at_most(1, {', '.join(some)})"


def _together(entry: Entry, groups: Sequence[Sequence[str]], layout: Layout) -> Iterator[str]:
    functions, pairs = layout.pattern.sources, layout.pattern.pairs
    for numbers in _groups(entry, groups, layout):
        for a, b in pairwise(numbers):
            optional = [f"{functions[i].path} is present" for i in (a, b) if functions[i].is_optional]
            for j in range(len(layout.targets)):
                left, right = (layout.connected(i, j) if (i, j) in pairs else "false" for i in (a, b))
                yield f"{' and '.join(optional)} implies ({left} iff {right})" if optional else f"{left} iff {right}"


def _groups(entry: Entry, groups: Sequence[Sequence[str]], layout: Layout) -> Iterator[list[int]]:
    for place, group in enumerate(groups):
        if len(group) < 2:
            raise fail(f"'{entry.name}' needs two functions or more", entry[place].where, f"{entry.name}: [[acc, aeb]]")
        yield [_number(entry[place][step], name, layout.pattern.sources) for step, name in enumerate(group)]
