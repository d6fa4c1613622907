"""A sum with few distinct values said in clauses: a counter that walks over its variables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import combinations

from dse.space.flat import Linear
from dse.space.methods.dnnf.trim import UnsupportedError

Case = tuple[list[int], int]
"""Literals that hold together, and what the sum gains by it."""

MOST_STATES = 64
"""Distinct sums a counter may have to tell apart at one variable."""


def encode_linear(
    rule: Linear, cases: Mapping[int, list[Case]], new: Callable[[], int], add: Callable[[list[int], int], None]
) -> None:
    """Say that the sum stays within its bounds; *cases* of a variable exclude each other and leave nothing out.

    A sequential counter (Sinz 2005) over sums instead of ones: after each variable exactly one literal says what
    has been gathered, so the choices determine every literal and models stay one to one. Sums that can no longer
    matter are one. Raises UnsupportedError if there are more than MOST_STATES at a variable.
    """
    numbers = sorted(number for number in cases if any(amount for _, amount in cases[number]))
    least, most = _rest(numbers, cases)
    low = rule.low if rule.low is not None else least[0]
    high = rule.high if rule.high is not None else most[0]
    states: dict[int | None, int] = {0: 0}
    for at, number in enumerate(numbers):
        steps: list[tuple[list[int], int | None]] = []
        for state, literal in states.items():
            if state is None:
                steps.append(([literal], None))
                continue
            for holds, amount in cases[number]:
                gathered = state + amount
                together = [literal, *holds]
                if gathered + most[at + 1] < low or gathered + least[at + 1] > high:
                    add([each ^ 1 for each in together], rule.owner)
                elif low <= gathered + least[at + 1] and gathered + most[at + 1] <= high:
                    steps.append((together, None))
                else:
                    steps.append((together, gathered))
        ends = dict.fromkeys(state for _, state in steps)
        if len(ends) > MOST_STATES:
            raise UnsupportedError(f"rule {rule.owner} is a sum of too many distinct values")
        after = {state: new() for state in ends}
        for holds, end in steps:
            add([*(each ^ 1 for each in holds), after[end]], rule.owner)
        add(list(after.values()), rule.owner)
        for one, other in combinations(after.values(), 2):
            add([one ^ 1, other ^ 1], rule.owner)
        states = after
    if not numbers and not low <= 0 <= high:
        add([], rule.owner)


def _rest(numbers: list[int], cases: Mapping[int, list[Case]]) -> tuple[list[int], list[int]]:
    """Least and greatest sum of the variables from each place on."""
    least, most = [0], [0]
    for number in reversed(numbers):
        amounts = [amount for _, amount in cases[number]]
        least.append(least[-1] + min(amounts))
        most.append(most[-1] + max(amounts))
    return least[::-1], most[::-1]
