"""The reduced multivalued decision diagram of a design space: one layer for each variable, a path for each row.

A node of a layer is what the rules remember of the variables before it, packed into machine words; a layer is
expanded at once, equal nodes become one, and a second sweep from the end removes dead nodes and merges those with
equal futures (Srinivasan, Kam, Malik and Brayton 1990; Bryant's reduction 1986). Canonical for an order: two spaces
with the same rows have equal layers.

Example: a, b, c are 0 or 1; a implies b; b implies c.

    layer a: one node, the root
    layer b: after a = 1, b must be 1; after a = 0 it is free           2 nodes
    layer c: after b = 1, c must be 1; after b = 0 it is free           2 nodes
    rows below, from the end: c has 1 and 2, b has 1 and 1 + 2, a has 1 + 3 = 4

Cost: nodes times values, for the diagram and for each question. The nodes depend on the order of the variables
(`dse.space.methods.mdd.ordering`): a model of 854 features fits, one of 2,513 does not in any order that was tried
(docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Bools, FlatSpace, Ints
from dse.space.methods.mdd.automata import Automaton, read
from dse.space.methods.mdd.distinct import distinct_rows
from dse.space.methods.mdd.growth import Growth

MOST_DIAGRAM_NODES = 500_000
"""Nodes before reduction that a diagram may have unless told otherwise."""

_SAFE = 1 << 62


@dataclass(frozen=True, slots=True, eq=False)
class DecisionDiagram:
    """Rows of a space as paths from node 0 of layer 0 to the terminal, which is node 0 after the last layer.

    *order* names the variable of each layer; layers[k][node, value] is a node of layer k + 1 or -1, the last column
    is for `ABSENT`. No node is dead or unreachable, no two nodes of a layer are equal. *empty*: every layer has 0
    nodes. Linear and Wide rules of *flat* are in the layers only if *expanded*.
    """

    flat: FlatSpace
    order: tuple[int, ...]
    layers: tuple[NDArray[np.int32], ...]
    empty: bool
    expanded: bool


def compile_diagram(
    flat: FlatSpace, order: Sequence[int] | None = None, most_nodes: int = MOST_DIAGRAM_NODES
) -> DecisionDiagram:
    """Hierarchy, tables and clauses of *flat*, by default in its own order; TooWideError beyond *most_nodes*."""
    order = tuple(range(len(flat.variables))) if order is None else tuple(order)
    reading = read(flat, order)
    if reading.contradiction:
        return reduced(flat, order, None, expanded=False)
    fields, words = pack(reading.automata, len(order))
    states = np.zeros((words, 1), np.int64)
    growth = Growth(most_nodes)
    for mask, touched in zip(reading.masks, fields, strict=True):
        states = growth.grow(states, len(mask), partial(_successors, mask, touched))
        if not states.shape[1]:
            return reduced(flat, order, None, expanded=False)
    return reduced(flat, order, growth.layers, expanded=False)


def reduced(
    flat: FlatSpace, order: tuple[int, ...], layers: Sequence[NDArray[np.int32]] | None, *, expanded: bool
) -> DecisionDiagram:
    """The diagram of layers whose nodes are all reachable, without dead nodes and with equal nodes merged.

    Layers None, or a dead root, say that it is empty. Nodes are numbered in the lexicographic order of their children.
    """
    done: list[NDArray[np.int32]] = []
    renamed = np.array([0, -1], np.int32)
    for layer in reversed(layers or ()):
        children = renamed[layer]
        alive = (children >= 0).any(axis=1)
        if not alive.any():
            layers = None
            break
        if not alive.all():
            children = children[alive]
        first, classes = distinct_rows(children + 1, int(renamed.max()) + 2)
        done.append(children[first])
        renamed = np.full(len(layer) + 1, -1, np.int32)
        renamed[:-1][alive] = classes
    if layers is None:
        nothing = tuple(np.zeros((0, len(flat.variables[variable].values) + 1), np.int32) for variable in order)
        return DecisionDiagram(flat, order, nothing, True, expanded)
    return DecisionDiagram(flat, order, tuple(reversed(done)), False, expanded)


def restrict(diagram: DecisionDiagram, masks: Mapping[int, Bools]) -> DecisionDiagram:
    """The rows whose variables take values in *masks*, by variable, of shape (values + 1,); fast enough to type by."""
    if diagram.empty:
        return diagram
    layers: list[NDArray[np.int32]] = []
    reached = np.ones(1, np.bool_)
    for variable, layer in zip(diagram.order, diagram.layers, strict=True):
        mask = masks.get(variable)
        children = layer if mask is None else np.where(mask, layer, np.int32(-1))
        if not reached.all():
            children = np.where(reached[:, None], children, np.int32(-1))
        layers.append(children)
        reached = np.zeros(int(layer.max()) + 1, np.bool_)
        reached[children[children >= 0]] = True
        if not reached.any():
            return reduced(diagram.flat, diagram.order, None, expanded=diagram.expanded)
    return reduced(diagram.flat, diagram.order, layers, expanded=diagram.expanded)


def completions(diagram: DecisionDiagram) -> list[NDArray[Any]]:
    """In how many ways each node can be completed: per layer, shape (nodes,), the terminal's layer included.

    Exact: int64 while the numbers are small, Python integers in object arrays above.
    """
    number: NDArray[Any] = np.ones(0 if diagram.empty else 1, np.int64)
    numbers = [number]
    for layer in reversed(diagram.layers):
        if number.dtype != object and len(number) and int(number.max()) * layer.shape[1] >= _SAFE:
            number = number.astype(object)
        # The child -1 finds the zero at the end.
        number = np.append(number, np.zeros(1, number.dtype))[layer].sum(axis=1)
        numbers.append(number)
    return numbers[::-1]


def count(diagram: DecisionDiagram) -> int:
    """How many rows the diagram has; rules that are not in the layers do not count."""
    return 0 if diagram.empty else int(completions(diagram)[0][0])


def occurrences(diagram: DecisionDiagram) -> tuple[tuple[int, ...], ...]:
    """For each variable in file order: in how many rows it takes each of its values, and in how many it is absent."""
    found: list[tuple[int, ...]] = [(0,) * (len(variable.values) + 1) for variable in diagram.flat.variables]
    if diagram.empty:
        return tuple(found)
    below = completions(diagram)
    if int(below[0][0]) * max((layer.shape[1] for layer in diagram.layers), default=1) >= _SAFE:
        below = [numbers.astype(object) for numbers in below]
    above = np.ones(1, below[0].dtype)
    for variable, layer, after in zip(diagram.order, diagram.layers, below[1:], strict=True):
        source, value = np.nonzero(layer >= 0)
        child = layer[source, value]
        paths = above[source]
        through = np.zeros(layer.shape[1], above.dtype)
        np.add.at(through, value, paths * after[child])
        found[variable] = tuple(int(number) for number in through)
        above = np.zeros(len(after), above.dtype)
        np.add.at(above, child, paths)
    return tuple(found)


def extremes(diagram: DecisionDiagram, weights: Mapping[int, Ints]) -> tuple[list[Ints], list[Ints]]:
    """Least and greatest sum of weights[variable][value] over the completions of each node.

    Per layer, shape (nodes,), the terminal's layer included; variables without weights count 0.
    """
    low = high = np.zeros(0 if diagram.empty else 1, np.int64)
    lows, highs = [low], [high]
    for variable, layer in zip(reversed(diagram.order), reversed(diagram.layers), strict=True):
        possible = layer >= 0
        weight = weights.get(variable, np.int64(0))
        if not diagram.empty:
            low = np.min(low[layer] + weight, axis=1, where=possible, initial=np.iinfo(np.int64).max)
            high = np.max(high[layer] + weight, axis=1, where=possible, initial=np.iinfo(np.int64).min)
        lows.append(low)
        highs.append(high)
    return lows[::-1], highs[::-1]


def _successors(mask: Bools, touched: Sequence[Field], states: Ints) -> tuple[Ints, list[Ints]]:
    """Pairs node * values + value that no rule rejects, and the words after each."""
    words, nodes = states.shape
    allowed = np.broadcast_to(mask, (nodes, len(mask)))
    kept = [-1] * words
    written: dict[int, Ints] = {}
    for field in touched:
        if field.starts:
            after = field.step[:1]
        else:
            kept[field.word] &= ~(field.mask << field.shift)
            after = field.step[(states[field.word] >> field.shift) & field.mask]
        allowed = allowed & (after >= 0)
        if not field.ends:
            shifted = after << field.shift
            before = written.get(field.word)
            written[field.word] = shifted if before is None else before | shifted
    pairs = np.flatnonzero(allowed)
    source, value = np.divmod(pairs, len(mask))
    after_all = []
    for word in range(words):
        column = (states[word] & kept[word])[source]
        if word in written:
            extra = written[word]
            column |= extra[source, value] if len(extra) == nodes else extra[0, value]
        after_all.append(column)
    return pairs, after_all


_BITS = 62
"""Of a word: it stays positive, and sums of two do not overflow."""


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """What one automaton does in one layer: its bits in a word, and its step."""

    word: int
    shift: int
    mask: int
    step: Ints
    starts: bool
    ends: bool


def pack(automata: Sequence[Automaton], layers: int) -> tuple[list[list[Field]], int]:
    """The fields that each layer touches, and how many words a node needs."""
    fields: list[list[Field]] = [[] for _ in range(layers)]
    starting: list[list[Automaton]] = [[] for _ in range(layers)]
    freed: list[list[tuple[int, int]]] = [[] for _ in range(layers)]
    free: list[int] = []
    for automaton in automata:
        starting[automaton.layers[0]].append(automaton)
    for layer, automata_here in enumerate(starting):
        for word, bits in freed[layer]:
            free[word] |= bits
        for automaton in automata_here:
            bits = (automaton.states() - 1).bit_length()
            word, shift = _place(free, bits)
            mask = (1 << bits) - 1
            free[word] &= ~(mask << shift)
            last = automaton.layers[-1]
            freed[last].append((word, mask << shift))
            for at, step in zip(automaton.layers, automaton.steps, strict=True):
                fields[at].append(Field(word, shift, mask, step, at == layer, at == last))
    return fields, len(free)


def _place(free: list[int], bits: int) -> tuple[int, int]:
    """First word and shift with that many free bits in a row; a new word if there is none."""
    for word, available in enumerate(free):
        starts = available
        for _ in range(bits - 1):
            starts &= starts >> 1
        if starts:
            return word, (starts & -starts).bit_length() - 1
    free.append((1 << _BITS) - 1)
    return len(free) - 1, 0
