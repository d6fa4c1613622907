"""The functions of model.h that have to do with events: relations, reinit, and what asserts say."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from dse.modelica.algebra.expression import ORDERINGS, Expression, shown
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.emit.blocks import scoped
from dse.modelica.emit.expressions.scope import Store, scope_lines
from dse.modelica.emit.expressions.setting import Setting, quoted
from dse.modelica.flat_model import Check, FlatModel, Relation
from dse.modelica.solved_model import Solved

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
    """Where *relation* stands, and how it reads."""
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
