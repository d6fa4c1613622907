"""The states that are selected during the run, as tables for the runtime."""

from __future__ import annotations

from dse.modelica.algebra.symbol import Symbol
from dse.modelica.emit.expressions.setting import Collected, locations
from dse.modelica.emit.expressions.text import literal, table
from dse.modelica.emit.memory import MemoryLayout
from dse.modelica.solved_model import Selection, Solved


def selection_lines(solved: Solved, memory: MemoryLayout, collected: Collected) -> list[str]:
    """``dse_selections`` and what it points to; nothing for a model without."""
    lines: list[str] = []
    entries = []
    for number, one in enumerate(solved.selections):
        at = f" at {locations(one.where)}" if one.where else ""
        what = f"the equations{at}, {one.subject}, are singular: there are no states that could be selected"
        failure = collected.failure(what)
        for name, places in _places(one, memory).items():
            lines += table(f"static const uint32_t dse_{name}_{number}[]", [str(place) for place in places])
        for name, values in {"units": one.units, "weights": one.weights}.items():
            lines += table(f"static const double dse_{name}_{number}[]", [literal(value) for value in values])
        sizes = (one.rows, len(one.weights), len(one.candidates), one.never, one.levels, failure)
        names = ("matrix", "candidates", "states", "shares", "units", "weights")
        entries.append(f"{{{', '.join(map(str, sizes))}, {', '.join(f'dse_{name}_{number}' for name in names)}}}")
    return [*lines, *table("static const struct dse_selection dse_selections[]", entries)] if entries else []


def _places(one: Selection, memory: MemoryLayout) -> dict[str, list[int]]:
    """Places in ``v``; of candidates and states those of their derivatives behind them."""
    levels = range(one.levels)
    return {
        "matrix": [memory.of(name) for name in one.matrix],
        "candidates": [memory.places[Symbol(own.name, own.order + k)] for k in levels for own in one.candidates],
        "states": [memory.places[Symbol(name, k)] for k in levels for name in one.states],
        "shares": [memory.of(name) for row in one.shares for name in row],
    }
