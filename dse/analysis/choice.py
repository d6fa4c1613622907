"""Which design of a study to take: the first in the order, the next one, and what decides between them.

The report's page has the same (`choice.ts`); both are tested with `tests/order_cases.json`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from dse.analysis.decision import Decision, decide_between, is_price, point_of
from dse.analysis.design_ranking import objectives_of, ordered
from dse.domain.definition import StudyDefinition
from dse.domain.sampler import Objective, Role
from dse.exploration import equal_rows
from dse.storage import RunTable, over_draws


@dataclass(frozen=True, slots=True)
class Choice:
    """Of *designs*, of which *feasible* meet every requirement at all *conditions*, the first of *decision* is the one
    to take, with *run* as one of its runs, and its second the next one in the order.

    *cheaper* misses as many verdicts of each class and has the lowest *price*: its configuration, values of its design
    variables, and one of its runs; None if that is the first one, or if the study has no price.
    """

    decision: Decision
    run: int
    designs: int
    feasible: int
    conditions: int
    price: str
    cheaper: tuple[str, Mapping[str, float], int] | None


def choice_of(
    table: RunTable, assumed: Iterable[str] | None = None, objectives: Sequence[Objective] | None = None
) -> Choice | None:
    """*table*, *assumed* and *objectives* are as for `decide_between`.

    None for a study without requirements or with one design, and if no design was run at all conditions.
    """
    definition, merged = table.header.definition, over_draws(table)
    wanted = objectives_of(definition, (), ()) if objectives is None else objectives
    if not len(merged) or not definition.requirements:
        return None
    _, designs, _, order = ordered(merged, wanted)
    first, *others = order.first_to_last
    if not others or not order.is_whole[first]:
        return None
    runs = [int(merged.numbers[rows[0]]) for rows in designs.rows]
    decision = decide_between(table, str(runs[first]), str(runs[others[0]]), assumed, wanted)
    last = 1 + 2 * order.judged.shape[1]
    alike = [row for row in others if (order.keys[row, :last] == order.keys[first, :last]).all()]
    price = next(prices_of(definition), "")

    def cost(row: int) -> float:
        return definition.configuration(designs.configurations[row]).totals[price].value

    cheapest = min((first, *alike), key=cost) if price else first
    at = [n for n, v in enumerate(merged.header.definition.variables) if v.role == Role.CONDITION]
    return Choice(
        decision,
        runs[first],
        len(designs),
        int((order.is_whole & (order.certain + order.doubtful == 0).all(axis=1)).sum()),
        len(equal_rows(merged.coordinates()[:, at])) if at else 1,
        price,
        None
        if cheapest == first
        else (
            designs.configurations[cheapest],
            point_of(merged, int(designs.rows[cheapest][0])),
            runs[cheapest],
        ),
    )


def prices_of(definition: StudyDefinition) -> Iterator[str]:
    """Sums of properties in a currency that each configuration has."""
    first, *others = definition.configurations
    for name, total in first.totals.items():
        if is_price(total.unit) and all(name in each.totals for each in others):
            yield name
