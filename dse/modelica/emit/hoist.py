"""What depends on parameters only is computed when parameters are set, not in every step."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import replaced, symbols, walk
from dse.modelica.emit.expressions.regions import cost
from dse.modelica.emit.expressions.setting import MemoryLayout
from dse.modelica.flat_model import Role
from dse.modelica.solved_model import EventBlock, Explicit, Solved, expressions, mapped, targets

# An addition or multiplication costs what loading its result would.
_WORTH_A_PLACE = 2


@dataclass(frozen=True, slots=True)
class Hoisted:
    """*solved* with its parameter-only parts replaced by new symbols, and *assignments* that compute these.

    *own* are the new symbols' places in ``v``. *gathered* are the arrays of parameter-only elements that do not stand
    in a row in ``v``, with the places in ``m->data`` where a copy does; *data_size* is their length together.
    *initial* and *guesses* are as before: parameters may be unknown there. *are_all_known* says that none is.
    """

    solved: Solved
    assignments: tuple[Explicit, ...]
    own: Mapping[Symbol, int]
    gathered: tuple[tuple[Expression, int], ...]
    data_size: int
    are_all_known: bool


def hoisted(solved: Solved, layout: MemoryLayout) -> Hoisted:
    """Take out of *solved* what depends on parameters only and costs more than reading a value."""
    known = _known_parameters(solved)
    moved = _moved(solved, known)
    fixed = known | {assignment.unknown for assignment in moved}
    kept = _without(solved, fixed)
    roots = list(_hot(kept))
    costs = _costs(roots, fixed)
    found = [node for node in _largest(roots, costs) if costs[node.number] >= _WORTH_A_PLACE]
    own = [Symbol(f"%{number}") for number in range(len(found))]
    graph = solved.flat.graph
    new = {node.number: graph.symbol(symbol) for node, symbol in zip(found, own, strict=True)}
    lean = _swapped(kept, roots, new)
    places = {symbol: layout.size + number for number, symbol in enumerate(own)}
    assignments = (*moved, *(Explicit(symbol, node) for symbol, node in zip(own, found, strict=True)))
    gathered, size = _gathered(_hot(lean), {**layout.places, **places}, fixed | set(own))
    return Hoisted(lean, assignments, places, gathered, size, len(known) == len(_parameters(solved)))


def _swapped(solved: Solved, roots: Sequence[Expression], new: Mapping[int, Expression]) -> Solved:
    """*solved* with the nodes whose numbers *new* knows replaced in *roots*, all that is evaluated at any time after
    the initialization."""
    others = replaced(roots, lambda node: new.get(node.number))
    by_number = {root.number: other for root, other in zip(roots, others, strict=True)}

    def swap(root: Expression) -> Expression:
        return by_number.get(root.number, root)

    return replace(
        solved,
        flat=solved.flat.mapped(swap),
        derivatives=tuple(mapped(block, swap) for block in solved.derivatives),
        outputs=tuple(mapped(block, swap) for block in solved.outputs),
        event=tuple(mapped(block, swap) for block in solved.event),
    )


def _known_parameters(solved: Solved) -> frozenset[Symbol]:
    """Parameters that are known before the initialization."""
    unknown = set(targets(solved.initial))
    for assignment in solved.parameters:
        if not unknown.isdisjoint(symbols(assignment.value)):
            unknown.add(assignment.unknown)
    return frozenset(_parameters(solved)) - unknown


def _parameters(solved: Solved) -> list[Symbol]:
    variables = solved.flat.variables.items()
    return [Symbol(name) for name, one in variables if one.role is Role.PARAMETER and name not in solved.aliases]


def _moved(solved: Solved, known: frozenset[Symbol]) -> list[Explicit]:
    """Assignments of the hot functions that need nothing but parameters and each other."""
    fixed = set(known)
    found = []
    for block in (*solved.derivatives, *solved.outputs):
        if isinstance(block, Explicit) and fixed.issuperset(symbols(block.value)):
            found.append(block)
            fixed.add(block.unknown)
    return found


def _without(solved: Solved, moved: frozenset[Symbol]) -> Solved:
    def is_kept(block: EventBlock) -> bool:
        return not (isinstance(block, Explicit) and block.unknown in moved)

    return replace(
        solved,
        derivatives=tuple(block for block in solved.derivatives if is_kept(block)),
        outputs=tuple(block for block in solved.outputs if is_kept(block)),
        event=tuple(block for block in solved.event if is_kept(block)),
    )


def _hot(solved: Solved) -> Iterator[Expression]:
    """What is evaluated after the initialization."""
    flat = solved.flat
    for block in (*solved.derivatives, *solved.outputs, *solved.event):
        yield from expressions(block, flat)
    yield from (one.truth for one in flat.relations)
    yield from (one.value for one in flat.reinitializations)
    yield from (one.condition for one in flat.checks)


def _costs(roots: Iterable[Expression], fixed: frozenset[Symbol]) -> dict[int, int]:
    """Cost of each node that depends on *fixed* symbols only and cannot fail, by its number."""
    found: dict[int, int] = {}
    for node in walk(roots):
        if node.symbol is not None:
            is_fixed = node.symbol in fixed
        else:
            is_fixed = node.operator not in ("array", "call", "select")
            is_fixed = is_fixed and all(operand.number in found for operand in node.operands)
        if is_fixed:
            # Bounded: in a graph with shared nodes the sum could grow without limit.
            below = sum(found[operand.number] for operand in node.operands)
            found[node.number] = min(cost(node) + below, _WORTH_A_PLACE)
    return found


def _largest(roots: Iterable[Expression], costs: Mapping[int, int]) -> Iterator[Expression]:
    """Nodes of *costs* that are roots, or that a node which is none of them needs; each once.

    Arrays of such nodes are copied whole, so that their elements need no places of their own.
    """
    listed = list(roots)
    rest = [
        node
        for node in walk(listed)
        if node.number not in costs and not (node.operator == "array" and _is_copied(node, costs))
    ]
    seen: set[int] = set()
    for needed in (*listed, *(operand for node in rest for operand in node.operands)):
        if needed.number in costs and needed.number not in seen:
            seen.add(needed.number)
            yield needed


def _is_copied(array: Expression, costs: Mapping[int, int]) -> bool:
    """Whether *array* consists of parameters and what follows from them, not of numbers alone."""
    return not all(element.is_constant for element in array.operands) and all(
        element.number in costs for element in array.operands
    )


def _gathered(
    roots: Iterable[Expression], places: Mapping[Symbol, int], fixed: frozenset[Symbol]
) -> tuple[tuple[tuple[Expression, int], ...], int]:
    """Arrays of fixed elements that need a copy, with its place in ``m->data``; and how long all copies are."""
    listed = list(roots)
    costs = _costs(listed, fixed)
    found: list[tuple[Expression, int]] = []
    size = 0
    for node in walk(listed):
        if node.operator == "array" and _is_copied(node, costs):
            row = [places.get(element.symbol) if element.symbol else None for element in node.operands]
            if row[0] is None or row != list(range(row[0], row[0] + len(row))):
                found.append((node, size))
                size += len(node.operands)
    return tuple(found), size
