"""A solved model with some of its expressions replaced by others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.traversal import replaced
from dse.modelica.flat_model import FlatModel
from dse.modelica.solved_model import Activation, EventBlock, Explicit, Solved, System, When

Swap = Callable[[Expression], Expression]
_Block = TypeVar("_Block", bound=EventBlock)


def swapped(solved: Solved, roots: Sequence[Expression], new: Mapping[int, Expression]) -> Solved:
    """*solved* with the nodes whose numbers *new* knows replaced in what is evaluated after the initialization.

    *roots* are all expressions evaluated there.
    """
    others = replaced(roots, lambda node: new.get(node.number))
    by_number = {root.number: other for root, other in zip(roots, others, strict=True)}

    def swap(root: Expression) -> Expression:
        return by_number[root.number]

    return replace(
        solved,
        flat=_flat(solved.flat, swap),
        derivatives=tuple(_block(block, swap) for block in solved.derivatives),
        outputs=tuple(_block(block, swap) for block in solved.outputs),
        event=tuple(_block(block, swap) for block in solved.event),
    )


def _flat(flat: FlatModel, swap: Swap) -> FlatModel:
    return replace(
        flat,
        relations=tuple(replace(relation, truth=swap(relation.truth)) for relation in flat.relations),
        triggers=tuple(
            replace(trigger, conditions=tuple(swap(condition) for condition in trigger.conditions))
            for trigger in flat.triggers
        ),
        reinitializations=tuple(replace(each, value=swap(each.value)) for each in flat.reinitializations),
        checks=tuple(replace(check, condition=swap(check.condition)) for check in flat.checks),
    )


def _block(block: _Block, swap: Swap) -> _Block:
    if isinstance(block, Explicit):
        return replace(block, value=swap(block.value))
    if isinstance(block, System):
        return replace(
            block,
            inner=tuple(replace(assignment, value=swap(assignment.value)) for assignment in block.inner),
            residuals=tuple(swap(residual) for residual in block.residuals),
            jacobian=tuple(tuple(swap(entry) for entry in row) for row in block.jacobian),
        )
    if isinstance(block, When):
        return replace(block, branches=tuple((trigger, swap(value)) for trigger, value in block.branches))
    assert isinstance(block, Activation)  # noqa: S101  (tells the type checker that no other kind is left)
    return block
