"""The benches of a study when only some of its runs are to have error bars: those near a boundary."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from dse.errors import Problem, raise_if_any
from dse.testbench.error_bars import with_error_bars
from dse.testbench.multi_bench import Prepared, singly, together
from dse.testbench.numerics import Say
from dse.testbench.study import PreparedStudy
from dse.testbench.variations import can_halve


def require_checkable(planned: PreparedStudy, names: Iterable[str]) -> None:
    """Raise DseError if configurations of *names* can make neither half the step nor twice the step until the end."""
    odd = [
        name
        for name in names
        for bench in singly(planned.benches[name])
        if bench.simulation.steps % 2 and not can_halve(bench.system, bench.simulation)
    ]
    what = f"{len(odd)} configurations have an FMU that cannot make half the step, and twice the step ends late"
    hint = "leave out check_step, or let the bench's 'stop' be an even number of steps"
    raise_if_any([Problem(f"{what}, as {odd[0]}", planned.study.where, hint)] if odd else [])


def checked_benches(
    planned: PreparedStudy,
    names: Iterable[str],
    *,
    cache: Path | None = None,
    say: Say = lambda _: None,
    sandboxed: bool = False,
) -> dict[str, Prepared]:
    """The benches of the configurations *names*, each of whose runs is repeated; the rest as for `with_error_bars`.

    Raises DseError as `require_checkable` does, which can be asked before.
    """
    names = tuple(names)
    require_checkable(planned, names)
    studied = planned.study.benches
    benches: dict[str, Prepared] = {}
    for name in names:
        made = []
        for on, bench in zip(studied, singly(planned.benches[name]), strict=True):
            asked = replace(bench, simulation=replace(bench.simulation, check_step=True))
            parts = {**bench.configuration.parts, **{part.name: part.component for part in on.test_components}}
            made.append(with_error_bars(asked, parts, cache=cache, say=say, sandboxed=sandboxed))
        benches[name] = together(made, [bench.name for bench in studied])
    return benches
