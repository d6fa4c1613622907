"""Systems of equations as C: linear ones are solved on the spot, the others by the runtime's Newton method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from dse.errors import fail
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import replaced
from dse.modelica.emit.expressions.scope import Store, scope_lines
from dse.modelica.emit.expressions.setting import Setting, literal, table
from dse.modelica.flat_model import FlatModel
from dse.modelica.solved_model import Explicit, System

LARGEST = 128
"""Unknowns of one system; its matrices lie on the stack."""


def system_lines(system: System, flat: FlatModel, setting: Setting) -> list[str]:
    """The statements that solve *system* and assign all it computes.

    Raises DseError if it has more than `LARGEST` unknowns.
    """
    size = len(system.unknowns)
    if size > LARGEST:
        where = system.where[0] if system.where else None
        what = f"{size} equations depend on each other; {LARGEST} can be solved together"
        raise fail(what, where, "break the loop, or write the model with fewer algebraic couplings")
    setting.collected.largest_system = max(setting.collected.largest_system, size)
    return _linear(system, setting) if system.is_linear else _newton(system, flat, setting)


def explicit_store(block: Explicit, setting: Setting) -> Store:
    """The assignment of *block*."""
    return Store(setting.symbol(block.unknown), block.value, f"in the equation for {block.unknown}")


def _subject(system: System, setting: Setting) -> str:
    """Which equations, and what they are to be solved for."""
    names = [str(unknown) for unknown in system.unknowns]
    shown = ", ".join(names[:6]) + (", …" if len(names) > 6 else "")
    at = setting.locations(system.where)
    return f"the equations{' at ' + at if at else ''} for {shown}"


def _linear(system: System, setting: Setting) -> list[str]:
    size = len(system.unknowns)
    subject = _subject(system, setting)
    graph = system.residuals[0].graph
    right = [graph.make("negate", residual) for residual in _at_zero(system)]
    entries = [
        (row * size + column, entry)
        for row, line in enumerate(system.jacobian)
        for column, entry in enumerate(line)
        if not entry.is_number(0)
    ]
    stores = [
        *(Store(f"a[{place}]", entry, f"in {subject}") for place, entry in entries),
        *(Store(f"b[{row}]", entry, f"in {subject}") for row, entry in enumerate(right)),
    ]
    singular = setting.failing(f"{subject} have no unique solution: they are singular")
    places = [setting.place(unknown) for unknown in system.unknowns]
    lines = ["    {", f"        double a[{size * size}] = {{0.0}};", f"        double b[{size}];"]
    lines += scope_lines(stores, setting)
    if size == 1:
        lines += [f"        if (!(fabs(a[0]) > 0.0)) {{ {singular} }}", f"        v[{places[0]}] = b[0] / a[0];"]
    else:
        lines.append(f"        if (dse_solve({size}, a, b)) {{ {singular} }}")
        lines += [f"        v[{place}] = b[{row}];" for row, place in enumerate(places)]
    lines.append("    }")
    if system.inner:
        inner = [explicit_store(assignment, setting) for assignment in system.inner]
        lines += ["    {", *scope_lines(inner, setting), "    }"]
    return lines


def _at_zero(system: System) -> list[Expression]:
    """The residuals with all unknowns 0, so that the solution does not depend on what the unknowns were before."""
    graph = system.residuals[0].graph
    values: dict[Symbol, Expression] = {unknown: graph.constant(0.0) for unknown in system.unknowns}

    def new(node: Expression) -> Expression | None:
        return values.get(node.symbol) if node.symbol is not None else None

    for assignment in system.inner:
        values[assignment.unknown] = replaced([assignment.value], new)[0]
    return replaced(system.residuals, new)


def _newton(system: System, flat: FlatModel, setting: Setting) -> list[str]:
    size = len(system.unknowns)
    number = _function(system, flat, setting)
    subject = _subject(system, setting)
    way = ", continued from the simplified expressions of homotopy" if system.is_continued else ""
    failure = setting.collected.failure(f"{subject} cannot be solved: Newton's method finds no solution{way}")
    arguments = f"m, {size}, dse_unknowns_{number}, dse_scales_{number}, dse_system_{number}"
    call = f"dse_newton({arguments}, {failure})"
    if system.is_continued:
        call = f"dse_continue({arguments}, &m->continued, {failure})"
    return [
        "    {",
        f"        const int code = {call};",
        f"        if (code) {{ {setting.on_failure.format(code='code')} }}",
        "    }",
    ]


def _function(system: System, flat: FlatModel, setting: Setting) -> int:
    """The number of the C function of *system*; equal systems have one."""
    key = (
        system.unknowns,
        tuple((assignment.unknown, assignment.value.number) for assignment in system.inner),
        tuple(residual.number for residual in system.residuals),
        tuple(entry.number for row in system.jacobian for entry in row),
        setting.is_initial,
    )
    known = setting.collected.systems.get(key)
    if known is not None:
        return known
    number = setting.collected.systems[key] = len(setting.collected.systems)
    setting.collected.system_lines += _definition(number, system, flat, setting)
    return number


def _definition(number: int, system: System, flat: FlatModel, setting: Setting) -> list[str]:
    subject = _subject(system, setting)
    inside = replace(setting, on_failure="return {code};")
    values = [explicit_store(assignment, inside) for assignment in system.inner]
    values += [Store(f"residual[{k}]", entry, f"in {subject}") for k, entry in enumerate(system.residuals)]
    entries: Sequence[Expression] = [entry for row in system.jacobian for entry in row]
    slopes = [Store(f"jacobian[{k}]", entry, f"in {subject}") for k, entry in enumerate(entries)]
    return [
        *table(f"static const uint32_t dse_unknowns_{number}[]", [str(inside.place(u)) for u in system.unknowns]),
        *table(f"static const double dse_scales_{number}[]", [literal(_scale(u, flat)) for u in system.unknowns]),
        f"static int dse_system_{number}(dse_component *m, double *residual, double *jacobian) {{",
        "    double *const v = m->v;",
        "    (void)v;",
        "    {",
        *scope_lines(values, inside),
        "    }",
        "    if (!jacobian) {",
        "        return 0;",
        "    }",
        "    {",
        *scope_lines(slopes, inside),
        "    }",
        "    return 0;",
        "}",
    ]


def _scale(unknown: Symbol, flat: FlatModel) -> float:
    """The nominal value, if it does not depend on parameters; else 1."""
    declared = flat.variables.get(unknown.name) if unknown == Symbol(unknown.name) else None
    nominal = declared.nominal if declared else None
    return abs(nominal.value) if nominal is not None and nominal.is_constant and nominal.value else 1.0
