"""The tables of model.h, and start.c: what the runtime reads of a model without calling it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from dse.errors import fail
from dse.fmu import Row
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.emit.blocks import relation_text
from dse.modelica.emit.expressions.setting import MemoryLayout, Setting, literal, quoted, table
from dse.modelica.emit.hoist import Hoisted
from dse.modelica.emit.variables import Causality, FmuVariable, Variability
from dse.modelica.flat_model import Clock
from dse.modelica.solved_model import Solved, System, targets

TOKEN_SIZE = 80
"""Bytes of the token in start.c, always, so that model.h need not know it; the rest is 0."""


def size_lines(solved: Solved, memory: MemoryLayout, lean: Hoisted, largest_system: int) -> list[str]:
    """The sizes of everything, as modelica.h wants them."""
    continuous = {symbol for blocks in (solved.derivatives, solved.outputs) for symbol in targets(blocks)}
    sizes = {
        "MODEL": 1,
        "VALUES": memory.size + len(lean.own),
        "STATES": len(solved.states),
        "RELATIONS": len(solved.flat.relations),
        "CONDITIONS": memory.condition_count,
        "TRIGGERS": len(solved.flat.triggers),
        "CLOCKS": len(solved.flat.clocks),
        "PRE": len(memory.pre),
        "DISCRETES": len(set(targets(solved.event)) - continuous),
        "ROOTS": len(_roots(solved)),
        "CHECKS": len(solved.flat.checks),
        "DATA": lean.data_size,
        "LARGEST_SYSTEM": largest_system,
    }
    return [f"#define DSE_{name} {size}" for name, size in sizes.items()]


def table_lines(solved: Solved, setting: Setting) -> Iterator[str]:
    """Places of states, derivatives and discrete variables; clocks; what is told of relations and failures."""
    memory, derivatives = setting.layout, [state.derivative for state in solved.states]
    clocks = [_clock(clock) for clock in solved.flat.clocks]
    relations = [quoted(relation_text(relation, setting)) for relation in solved.flat.relations]
    yield from table("static const uint32_t dse_state[]", [str(memory.places[state]) for state in solved.states])
    yield from table("static const uint32_t dse_derivative[]", [str(memory.places[symbol]) for symbol in derivatives])
    yield from table("static const uint32_t dse_root[]", [str(memory.places[root]) for root in _roots(solved)])
    yield from table("static const char *const dse_state_names[]", [quoted(str(state)) for state in solved.states])
    yield from table("static const uint32_t dse_discrete[]", [str(memory.of(name)) for name in memory.pre])
    yield from table("static const char *const dse_relations[]", relations)
    yield from table("static const struct dse_clock dse_clocks[]", clocks, "{0, 0, 1, 0}")
    yield from table("static const char *const dse_failure[]", [quoted(text) for text in setting.collected.failures])


def selection_lines(solved: Solved, setting: Setting) -> list[str]:
    """``dse_selections`` and what it points to; nothing for a model without."""
    memory, lines, entries = setting.layout, list[str](), list[str]()
    for number, one in enumerate(solved.selections):
        at = f" at {setting.locations(one.where)}" if one.where else ""
        what = f"the equations{at}, {one.subject}, are singular: there are no states that could be selected"
        failure = setting.collected.failure(what)
        places = {
            "matrix": [memory.of(name) for name in one.matrix],
            "candidates": [memory.places[symbol] for symbol in one.every],
            "states": [memory.places[Symbol(name, level)] for level in range(one.levels) for name in one.states],
            "shares": [memory.of(name) for row in one.shares for name in row],
        }
        for name, found in places.items():
            lines += table(f"static const uint32_t dse_{name}_{number}[]", [str(place) for place in found])
        for name, values in {"units": one.units, "weights": one.weights}.items():
            lines += table(f"static const double dse_{name}_{number}[]", [literal(value) for value in values])
        sizes = (one.rows, len(one.weights), len(one.candidates), one.never, one.levels, failure)
        names = (*places, "units", "weights")
        entries.append(f"{{{', '.join(map(str, sizes))}, {', '.join(f'dse_{name}_{number}' for name in names)}}}")
    return [*lines, *table("static const struct dse_selection dse_selections[]", entries)] if entries else []


def _roots(solved: Solved) -> tuple[Symbol, ...]:
    """The unknowns of Newton's method while the model is integrated."""
    systems = (block for block in solved.derivatives if isinstance(block, System) and not block.is_linear)
    return tuple(unknown for system in systems for unknown in system.unknowns)


def _clock(clock: Clock) -> str:
    denominator = math.lcm(clock.period.denominator, clock.phase.denominator)
    numbers = [int(clock.period * denominator), int(clock.phase * denominator), denominator]
    if max(abs(number) for number in numbers) >= 2**31:
        what = f"the ticks of sample({float(clock.phase):g}, {float(clock.period):g}) cannot be counted exactly"
        raise fail(what, None, "round the period and the start to fewer digits")
    return "{" + ", ".join(str(number) for number in (*numbers, int(clock.is_from_start))) + "}"


def slot_rows(variables: Sequence[FmuVariable]) -> tuple[Row, ...]:
    """Every variable of the FMU, by value reference."""
    return tuple(Row(str(each.place), each.kind.name, _settable(each), len(each.items)) for each in variables)


def slot_lines(variables: Sequence[FmuVariable]) -> Iterator[str]:
    """The same as C."""
    rows = slot_rows(variables)
    slots = [f"DSE_VALUE({row.member}, {row.kind}, {row.settable}, {row.items})" for row in rows]
    yield f"#define DSE_SLOT_COUNT {len(variables)}u"
    yield from table("static const struct dse_slot dse_slots[]", slots, "DSE_VALUE(0, REAL, OUTPUT, 0)")
    yield from table("static const char *const dse_names[]", [quoted(each.name) for each in variables], '""')


def _settable(each: FmuVariable) -> str:
    if each.causality is Causality.INPUT:
        return "INPUT"
    if each.causality is Causality.PARAMETER:
        return "TUNABLE" if each.variability is Variability.TUNABLE else "FIXED"
    return "OUTPUT"


def start_lines(solved: Solved, variables: Sequence[FmuVariable], size: int, token: str) -> Iterator[str]:
    """start.c: the token, the starts of the *size* values in ``v``, the states' nominal values."""
    if len(token.encode()) >= TOKEN_SIZE:
        raise fail(f"the token '{token}' is longer than {TOKEN_SIZE - 1} bytes")
    starts = [0.0] * size
    for each in variables:
        if each.start is not None:
            starts[each.place] = each.start
    known = {Symbol(symbol.name): 0.0 for symbol in solved.states}
    known |= {Symbol(each.name): each.start for each in variables if each.start is not None}
    nominals = [_nominal(solved, state, known) for state in solved.states]
    yield f"const char dse_token[{TOKEN_SIZE}] = {quoted(token)};"
    yield from table("const double dse_starts[]", [literal(start) for start in starts], "0.0")
    yield from table("const double dse_nominals[]", [literal(nominal) for nominal in nominals], "1.0")


def _nominal(solved: Solved, state: Symbol, known: dict[Symbol, float]) -> float:
    """The state's nominal value at the parameters' starts; 1 where there is none that could be a scale."""
    declared = solved.flat.variables[state.name]
    if state.order > 0 or declared.nominal is None:
        return 1.0
    value = abs(evaluate([declared.nominal], lambda symbol: known.get(symbol, math.nan))[0])
    return value if 0.0 < value < math.inf else 1.0
