"""The blocks of a solved model as the functions of model.h: one pass over them in order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import groupby

from dse.modelica.emit.expressions.scope import Store, scope_lines
from dse.modelica.emit.expressions.setting import Setting
from dse.modelica.emit.systems import explicit_store, system_lines
from dse.modelica.flat_model import FlatModel, Trigger
from dse.modelica.solved_model import Activation, EventBlock, Explicit, System, When

# Compilers take more than linear time for long functions and long blocks.
_LINES_A_FUNCTION = 200
_ASSIGNMENTS_A_SCOPE = 150


def pass_lines(name: str, blocks: Iterable[EventBlock], flat: FlatModel, setting: Setting) -> list[str]:
    """The function *name*, which makes one pass over *blocks*; where it would be long, it calls several."""
    return function_lines(name, block_pieces(blocks, flat, setting))


def function_lines(name: str, pieces: Iterable[list[str]]) -> list[str]:
    """``static int name(dse_component *m)`` that does *pieces* in order and returns 0 at the end."""
    parts: list[list[str]] = [[]]
    for piece in pieces:
        if len(parts[-1]) + len(piece) > _LINES_A_FUNCTION and parts[-1]:
            parts.append([])
        parts[-1] += piece
    if len(parts) == 1:
        return _function(name, parts[0])
    names = [f"{name}_{number}" for number in range(len(parts))]
    calls = [line for part in names for line in ("    if (!code) {", f"        code = {part}(m);", "    }")]
    return [
        *(line for part, lines in zip(names, parts, strict=True) for line in _function(part, lines)),
        f"static int {name}(dse_component *m) {{",
        "    int code = 0;",
        *calls,
        "    return code;",
        "}",
    ]


def _function(name: str, lines: list[str]) -> list[str]:
    # Not inlined: several short functions put into one would be the long one again.
    head = f"static __attribute__((noinline)) int {name}(dse_component *m) {{"
    return [head, "    double *const v = m->v;", "    (void)v;", *lines, "    return 0;", "}"]


def block_pieces(blocks: Iterable[EventBlock], flat: FlatModel, setting: Setting) -> Iterator[list[str]]:
    """The statements of one pass over *blocks*, in pieces that may stand in functions of their own."""
    for is_explicit, run in groupby(blocks, lambda block: isinstance(block, Explicit)):
        if is_explicit:
            stores = [explicit_store(block, setting) for block in run if isinstance(block, Explicit)]
            yield from scopes(stores, setting)
            continue
        for block in run:
            match block:
                case System():
                    yield system_lines(block, flat, setting)
                case When():
                    yield _when(block, setting)
                case Activation(number):
                    yield activation_lines(number, flat.triggers[number], setting)


def scoped(stores: list[Store], setting: Setting) -> list[str]:
    """*stores* in a C block of their own."""
    return ["    {", *scope_lines(stores, setting), "    }"]


def scopes(stores: list[Store], setting: Setting) -> Iterator[list[str]]:
    """*stores* in C blocks of a size that compilers like."""
    for first in range(0, len(stores), _ASSIGNMENTS_A_SCOPE):
        yield scoped(stores[first : first + _ASSIGNMENTS_A_SCOPE], setting)


def _when(block: When, setting: Setting) -> list[str]:
    target = f"v[{setting.place(block.target)}]"
    subject = f"in the equation for {block.target}"
    lines: list[str] = []
    for trigger, value in block.branches:
        store = Store(target, value, subject)
        if trigger is None and not lines:
            return scoped([store], setting)
        if trigger is None:
            return [*lines, "    } else {", *scope_lines([store], setting), "    }"]
        lines.append(f"    {'} else ' if lines else ''}if (m->is_active[{trigger}]) {{")
        lines += scope_lines([store], setting)
    kept = f"{target} = m->pre[{setting.layout.pre[block.target.name]}];"
    return [*lines, "    } else {", f"        {kept}", "    }"] if lines else [f"    {kept}"]


def activation_lines(number: int, trigger: Trigger, setting: Setting) -> list[str]:
    """Whether *trigger* is active now: a condition became true, or a clock ticks; at the start, if it says so."""
    first = setting.layout.conditions[number]
    subject = f"in the condition of when-clause {number + 1}"
    places = range(first, first + len(trigger.conditions))
    stores = [
        Store(f"m->is_true[{place}]", condition, subject, wants_truth=True)
        for place, condition in zip(places, trigger.conditions, strict=True)
    ]
    lines = scoped(stores, setting) if stores else []
    if setting.is_initial:
        return [*lines, f"    m->is_active[{number}] = {int(trigger.at_start)};"]
    terms = [f"(m->is_true[{place}] && !m->was_true[{place}])" for place in places]
    terms += [f"m->ticks[{clock}]" for clock in trigger.clocks]
    return [*lines, f"    m->is_active[{number}] = {' || '.join(terms) or '0'};"]
