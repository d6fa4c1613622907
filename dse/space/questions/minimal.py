"""Minimal conflicting sets (U. Junker, QuickXplain: preferred explanations for over-constrained problems, 2004)."""

from __future__ import annotations

from collections.abc import Callable, Sequence


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
