"""A check on the front-end: functions of one name in different classes must not be taken for one another.

The front-end names a function by the word used in the call. Two functions of that name then become one, and a model
would be computed with the wrong one. Every call still says which definition it means.
"""

from __future__ import annotations

from typing import Any

from dse.errors import fail
from dse.modelica.flatten.document import Document


def check_calls(document: Document) -> None:
    """Raise DseError if a call means another function than the one that was kept under its name."""
    functions = document.flat["functions"]
    stack: list[Any] = [document.flat]
    while stack:
        item = stack.pop()
        if isinstance(item, list):
            stack += item
        elif isinstance(item, dict):
            call = item.get("FunctionCall")
            if isinstance(call, dict):
                called = call.get("name") or call["comp"]
                name, parts = called["name"], called["component_ref"]["parts"]
                kept = functions.get(name)
                if kept is not None and kept["def_id"] != parts[-1]["def_id"]:
                    what = f"'{name}', a function with the name of another one used in this model, is not supported"
                    raise fail(what, document.where(call), "give the functions different names")
            stack += [value for value in item.values() if isinstance(value, dict | list)]
