"""The module that a class from a notebook or script becomes, as a component runs in a process of its own."""

from __future__ import annotations

import ast
import builtins
import inspect
import sys
from collections.abc import Iterator
from symtable import SymbolTable, symtable
from textwrap import dedent
from types import FunctionType, ModuleType

from dse.errors import Location, fail


def module_of(class_: type, where: Location) -> str:
    """A module with the source of *class_*, and with the imports and constants that it uses.

    Raises DseError, at *where*, if there is no source, or if it uses something else that was defined beside it.
    """
    source, around = _source(class_, where)
    lines: list[str] = []
    unknown: list[str] = []
    for name in {*_names(symtable(source, class_.__name__, "exec"))} - {class_.__name__}:
        if name in around and name != "__file__":  # which is another one there
            line = _defined(name, around[name], class_.__module__)
            (lines if line else unknown).append(line or name)
        elif not hasattr(builtins, name) and name != "__file__":
            unknown.append(name)
    if unknown:
        what = f"class '{class_.__name__}' uses {', '.join(map(repr, sorted(unknown)))} from outside"
        hint = "define it in the class, or in a module, and give its file: source={'kind': 'python', 'files': […]}"
        raise fail(what, where, hint)
    return "\n".join([*sorted(lines), "", "", source])


def _source(class_: type, where: Location) -> tuple[str, dict[str, object]]:
    """The text of *class_*, and what is defined around it by name.

    It is found by a method: of a class in a notebook, inspect finds no file.
    """
    for method in vars(class_).values():
        if not isinstance(method, FunctionType):
            continue
        try:
            lines, at = inspect.findsource(method)
            nodes = ast.walk(ast.parse("".join(lines)))
        except (OSError, TypeError, SyntaxError):
            continue
        for node in nodes:
            if isinstance(node, ast.ClassDef) and node.name == class_.__name__ and node.lineno <= at + 1:
                end = node.end_lineno or 0
                if at < end:
                    first = min([node.lineno, *(each.lineno for each in node.decorator_list)])
                    return dedent("".join(lines[first - 1 : end])), method.__globals__
    what = f"class '{class_.__name__}' has no source text"
    raise fail(what, where, "define it in a file or a notebook, with the method step(self, inputs, h)")


def _names(table: SymbolTable) -> Iterator[str]:
    """The global names that a source uses, those of builtins among them."""
    yield from (symbol.get_name() for symbol in table.get_symbols() if symbol.is_referenced() and symbol.is_global())
    for child in table.get_children():
        yield from _names(child)


def _defined(name: str, value: object, beside: str) -> str:
    """A line that defines *name* as *value*; "" if none can: it is neither imported nor a constant."""
    if isinstance(value, ModuleType):
        return f"import {value.__name__} as {name}" if value.__name__ != name else f"import {name}"
    module, own = getattr(value, "__module__", None), getattr(value, "__name__", None)
    if module not in (None, beside, "__main__") and getattr(sys.modules.get(module), str(own), None) is value:
        return f"from {module} import {own} as {name}" if own != name else f"from {module} import {name}"
    try:
        is_constant = bool(ast.literal_eval(repr(value)) == value)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return ""
    return f"{name} = {value!r}" if is_constant else ""
