"""A solved model as C: ``model.h`` for the FMU runtime, and ``start.c`` with what may change without compiling anew."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise

from dse.domain.component import Solver
from dse.errors import fail
from dse.modelica.algebra.expression import Expression, shown
from dse.modelica.algebra.traversal import walk
from dse.modelica.emit.blocks import (
    activation_lines,
    block_pieces,
    check_lines,
    function_lines,
    pass_lines,
    reinitialization_lines,
    relation_lines,
    scoped,
    scopes,
)
from dse.modelica.emit.constant_data import selection_lines, size_lines, slot_lines, start_lines, table_lines
from dse.modelica.emit.expressions.printing import table_axes
from dse.modelica.emit.expressions.scope import Store, scope_lines
from dse.modelica.emit.expressions.setting import Collected, Setting, comment, literal, memory_layout
from dse.modelica.emit.hoist import Hoisted, hoisted
from dse.modelica.emit.variables import FmuVariable
from dse.modelica.solved_model import Activation, Solved, all_expressions

DEFAULT_TOLERANCE = 1e-6


def emit(
    solved: Solved,
    variables: Sequence[FmuVariable],
    token: str,
    solver: Solver = Solver.AUTO,
    tolerance: float = DEFAULT_TOLERANCE,
    names: Mapping[str, str] | None = None,
) -> dict[str, bytes]:
    """``model.h`` and ``start.c``, by name. *variables* are those of `variables`, in order of their references.

    *tolerance* is relative; a state's absolute one is it times the nominal value. *names* are those of files by their
    paths, for messages. Start values and *token* are in start.c only. Raises DseError for what cannot become C: too
    large a system, a clock too fine to count, a token too long.
    """
    memory = memory_layout(solved)
    lean = hoisted(solved, memory)
    collected = Collected()
    plain = Setting(memory, collected, names=names or {})
    functions = list(_functions(solved, plain, lean))
    selections = selection_lines(solved, plain)
    model = [
        comment(f"Generated from the Modelica model {solved.flat.name}."),
        "#ifndef DSE_MODEL_H",
        "#define DSE_MODEL_H",
        *size_lines(solved, memory, lean, collected.largest_system),
        f"#define DSE_BRANCHES {int(solved.flat.graph.uses('if'))}",
        *([f"#define DSE_SELECTIONS {len(solved.selections)}"] if selections else []),
        f"#define DSE_SOLVER DSE_{solver.name}_SOLVER",
        f"#define DSE_DEFAULT_TOLERANCE {literal(tolerance)}",
        '#include "arithmetic.h"',
        '#include "modelica.h"',
        *table_lines(solved, plain),
        *selections,
        *slot_lines(variables),
        *collected.array_lines(),
        *collected.system_lines,
        *functions,
        "#endif",
    ]
    start = start_lines(solved, variables, memory.size + len(lean.own), token)
    return {"model.h": _bytes(model), "start.c": _bytes(start)}


def _bytes(lines: Iterable[str]) -> bytes:
    return ("\n".join(lines) + "\n").encode("ascii")


def _functions(solved: Solved, plain: Setting, lean: Hoisted) -> Iterator[str]:
    hot = replace(plain, own=lean.own, gathered={node.number: place for node, place in lean.gathered})
    flat = lean.solved.flat
    yield from function_lines("model_parameters", _parameters(solved, lean, replace(plain, own=lean.own), hot))
    yield from pass_lines("model_guess", solved.guesses, solved.flat, plain)
    at_start = replace(hot if lean.are_all_known else plain, is_initial=True)
    yield from function_lines("model_initial", _initial(solved, at_start))
    yield from pass_lines("model_derivatives", lean.solved.derivatives, flat, hot)
    yield from pass_lines("model_outputs", lean.solved.outputs, flat, hot)
    yield from pass_lines("model_event", lean.solved.event, flat, hot)
    yield from relation_lines(flat, hot)
    yield from reinitialization_lines(lean.solved, hot)
    yield from check_lines(flat, hot)
    yield from _aliases(solved, plain)


def _parameters(solved: Solved, lean: Hoisted, setting: Setting, hot: Setting) -> Iterator[list[str]]:
    """Dependent parameters, what the hot functions need of them, copies of arrays, and a look at all tables' axes."""
    yield from block_pieces((*solved.parameters, *lean.assignments), solved.flat, setting)
    for node, place in lean.gathered:
        stores = [Store(f"m->data[{place + k}]", element, "in an array") for k, element in enumerate(node.operands)]
        yield from scopes(stores, hot)
    hoisted_values = (assignment.value for assignment in lean.assignments)
    yield from axis_checks(chain(all_expressions(lean.solved), hoisted_values), hot)


def _initial(solved: Solved, setting: Setting) -> Iterator[list[str]]:
    """The initial blocks; then the memory of all conditions, which is set without making any when-clause active."""
    yield from block_pieces(solved.initial, solved.flat, setting)
    decided = {block.trigger for block in solved.initial if isinstance(block, Activation)}
    for number, trigger in enumerate(solved.flat.triggers):
        if number not in decided:
            yield activation_lines(number, trigger, setting)


def _aliases(solved: Solved, setting: Setting) -> list[str]:
    graph = solved.flat.graph
    stores = []
    for name, place in setting.layout.own.items():
        kept, sign = solved.aliases[name]
        value = graph.symbol(kept)
        stores.append(Store(f"v[{place}]", value if sign > 0 else -value, f"in the equation for {name}"))
    head = ["static void model_aliases(dse_component *m) {", "    double *const v = m->v;", "    (void)v;"]
    return [*head, *scoped(stores, setting), "}"]


# The look at every table's axis before it is used.


def axis_checks(roots: Iterable[Expression], setting: Setting) -> Iterator[list[str]]:
    """Statements that fail unless every table's axis has at least two numbers, each greater than the one before.

    Raises DseError for an axis of constants that is wrong already.
    """
    axes = {axis.number: axis for node in walk(roots) for axis in table_axes(node)}
    for axis in axes.values():
        if all(element.is_constant for element in axis.operands):
            numbers = [element.value for element in axis.operands]
            if len(numbers) < 2 or any(not left < right for left, right in pairwise(numbers)):
                raise fail(_text(axis))
        else:
            yield _check(axis, setting)


def _text(axis: Expression) -> str:
    ends = ", …, ".join(shown(element) for element in (*axis.operands[:1], *axis.operands[1:][-1:]))
    return f"the axis of a table ({ends}) must have at least two numbers, each greater than the one before"


def _check(axis: Expression, setting: Setting) -> list[str]:
    size = len(axis.operands)
    place = setting.array(axis)
    failing = setting.failing(_text(axis))
    if place is not None:
        return [f"    if (dse_axis({place}, {size})) {{ {failing} }}"]
    stores = [Store(f"axis[{k}]", element, "in the axis of a table") for k, element in enumerate(axis.operands)]
    lines = ["    {", f"        double axis[{size}];", *scope_lines(stores, setting)]
    return [*lines, f"        if (dse_axis(axis, {size})) {{ {failing} }}", "    }"]
