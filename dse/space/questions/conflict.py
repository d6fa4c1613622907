"""Why nothing is left: a smallest set of constraints that nothing can meet together."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dse.domain.design import Constraint
from dse.errors import DseError, fail
from dse.space.methods.engine import Engine

_MANY = 100
"""Constraints from which on the solver takes less time than a diagram for each question, where it is installed."""


def conflict(engine: Engine) -> tuple[Constraint, ...]:
    """Constraints that nothing meets together while all but any one of them can be met, in the order of the file.

    None of them if the choices exclude each other whatever the constraints. Raises DseError if there is a valid
    configuration after all, or if that cannot be told.
    """
    if not engine.is_empty():
        raise _no_conflict(engine)
    if engine.is_solved or (len(engine.flat.constraints) > _MANY and engine.late):
        from dse.space.methods.solver import answers

        found = answers.conflict(engine.flat) or ()
    else:

        def consistent(owners: Sequence[int]) -> bool:
            return not engine.only(owners).is_empty()

        found = minimal_conflict(range(len(engine.flat.constraints)), consistent)
    return tuple(engine.flat.constraints[number] for number in found)


def _no_conflict(engine: Engine) -> DseError:
    hint = f"list them: dse enumerate {engine.flat.name}"
    return fail(f"'{engine.flat.name}' has valid configurations, so its constraints do not conflict", None, hint)


def minimal_conflict(items: Sequence[int], consistent: Callable[[Sequence[int]], bool]) -> tuple[int, ...]:
    """A subset of *items* that is inconsistent while each of its proper subsets is consistent, in their order.

    Empty if even no item at all is inconsistent. *items* as a whole must be inconsistent, and a superset of
    something inconsistent must be too. Earlier items are preferred in the answer. Takes about 2 k log2(n/k) + 2 k
    questions for a conflict of k among n.
    """
    if not consistent(()):
        return ()
    found = _conflict((), False, tuple(items), consistent)
    return tuple(item for item in items if item in found)


def _conflict(
    background: tuple[int, ...],
    grown: bool,  # whether the background has changed since it was last found consistent
    items: tuple[int, ...],
    consistent: Callable[[Sequence[int]], bool],
) -> frozenset[int]:
    # The depth is the logarithm of the number of constraints, so recursion is safe.
    if grown and not consistent(background):
        return frozenset()
    if len(items) == 1:
        return frozenset(items)
    half = len(items) // 2
    preferred, others = items[:half], items[half:]
    from_others = _conflict((*background, *preferred), True, others, consistent)
    kept = (*background, *(item for item in others if item in from_others))
    return from_others | _conflict(kept, bool(from_others), preferred, consistent)
