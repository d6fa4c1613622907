"""The functions of model.h: passes over blocks of a solved model in order, and relations, reinit and asserts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import groupby

from dse.modelica.algebra.expression import ORDERINGS, Expression, shown
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.emit.expressions.scope import Store, scope_lines
from dse.modelica.emit.expressions.setting import Setting, quoted
from dse.modelica.emit.systems import explicit_store, system_lines
from dse.modelica.flat_model import Check, FlatModel, Relation, Trigger
from dse.modelica.solved_model import Activation, EventBlock, Explicit, Solved, System, When

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


_SIGNS = {"less": "<", "less_equal": "<=", "greater": ">", "greater_equal": ">=", "equal": "==", "not_equal": "<>"}


def relation_lines(flat: FlatModel, setting: Setting) -> list[str]:
    """``model_relations``: difference of the sides and truth of every relation, from the current values."""
    stores = []
    for number, relation in enumerate(flat.relations):
        subject = f"in the relation {relation_text(relation, setting)}"
        stores.append(Store(f"crossing[{number}]", _difference(relation.truth), subject))
        stores.append(Store(f"truth[{number}]", relation.truth, subject, wants_truth=True))
    return [
        "static int model_relations(dse_component *m, double crossing[], uint8_t truth[]) {",
        "    double *const v = m->v;",
        "    (void)v, (void)crossing, (void)truth;",
        *scoped(stores, setting),
        "    return 0;",
        "}",
    ]


def _difference(truth: Expression) -> Expression:
    """What passes through zero where *truth* changes; for comparisons of discrete values it jumps."""
    graph = truth.graph
    if truth.operator in ORDERINGS:
        return truth.operands[0] - truth.operands[1]
    return graph.make("if", truth, graph.constant(1.0), graph.constant(-1.0))


def relation_text(relation: Relation, setting: Setting) -> str:
    """The place of *relation*, and its text."""
    truth = relation.truth
    text = shown(truth)
    if truth.operator in _SIGNS:
        left, right = truth.operands
        text = f"{shown(left)} {_SIGNS[truth.operator]} {shown(right)}"
    return f"{setting.locations((relation.where,))}: {text}" if relation.where else text


def reinitialization_lines(solved: Solved, setting: Setting) -> list[str]:
    """``model_reinitialize``: values of all active reinits first, then the states. 1: written, negative: failure."""
    groups: dict[Symbol, list[Store]] = {}
    triggers: dict[Symbol, list[int]] = {}
    for each in solved.flat.reinitializations:
        state, sign = solved.aliases.get(each.state, (Symbol(each.state), 1))
        value = each.value if sign > 0 else -each.value
        groups.setdefault(state, []).append(Store(f"new_{setting.place(state)}", value, f"in reinit({each.state}, …)"))
        triggers.setdefault(state, []).append(each.trigger)
    failing = replace(setting, on_failure="return -{code};")
    lines = ["static int model_reinitialize(dse_component *m) {", "    double *const v = m->v;"]
    lines += ["    int is_written = 0;", "    (void)v;"]
    writes: list[str] = []
    for state, stores in groups.items():
        place = setting.place(state)
        lines += [f"    double new_{place} = v[{place}];", f"    int sets_{place} = 0;"]
        for count, (store, trigger) in enumerate(zip(stores, triggers[state], strict=True)):
            lines.append(f"    {'} else ' if count else ''}if (m->is_active[{trigger}]) {{")
            lines += [*scope_lines([store], failing), f"        sets_{place} = 1;"]
        lines.append("    }")
        writes += [
            f"    if (sets_{place}) {{",
            f"        v[{place}] = new_{place};",
            "        is_written = 1;",
            "    }",
        ]
    return [*lines, *writes, "    return is_written;", "}"]


def check_lines(flat: FlatModel, setting: Setting) -> list[str]:
    """``model_check`` and ``model_event_check``: tell every assert that does not hold; 0 ok, 1 error, 2 terminate."""
    numbered = list(enumerate(flat.checks))
    always = (item for item in numbered if item[1].trigger is None)
    at_events = (item for item in numbered if item[1].trigger is not None)
    return [
        *_check_function("model_check", always, setting),
        *_check_function("model_event_check", at_events, setting),
    ]


def _check_function(name: str, checks: Iterable[tuple[int, Check]], setting: Setting) -> list[str]:
    lines = [f"static int {name}(dse_component *m, dse_tell *tell) {{", "    double *const v = m->v;"]
    lines += ["    int result = 0;", "    (void)v, (void)tell;"]
    for number, check in checks:
        failure = f"tell(m, {number}, 0, dse_failure[{{code}} - 1]); return 1;"
        inside = replace(setting, on_failure=failure)
        kind = "terminate" if check.terminates else "assert"
        at = f" at {setting.locations((check.where,))}" if check.where else ""
        store = Store("holds", check.condition, f"in the condition of the {kind}{at}", wants_truth=True)
        guard = "1" if check.trigger is None else f"m->is_active[{check.trigger}]"
        lines += [f"    if ({guard}) {{", "        int holds;", *scope_lines([store], inside)]
        lines += [
            "        if (!holds) {",
            f"            tell(m, {number}, {int(check.is_warning)}, {quoted(check.message)});",
        ]
        if check.terminates:
            # An error found in the same instant counts more than the wish to end.
            lines.append("            result = result == 1 ? 1 : 2;")
        elif not check.is_warning:
            lines.append("            result = 1;")
        lines += ["        }", "    }"]
    return [*lines, "    return result;", "}"]
