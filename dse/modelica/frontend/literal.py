"""Values as Modelica text, and the model that is another with some parameters changed."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping

Value = float | int | bool | str | tuple[float, ...]
"""A number, a truth value, or the name of an enumeration's item, written with its type: ``Lib.Mode.Gap``."""

WRAPPER = "DseWrapper"
_NAME = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)


def is_class_name(text: str) -> bool:
    """Whether *text* can be the full name of a class or of a component: letters, digits, underscores and dots."""
    return bool(_NAME.fullmatch(text))


def literal(value: Value) -> str:
    """*value* as Modelica text that reads back as the same value. Raises ValueError for what has none."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"Modelica has no number {value}")
        text = repr(value)
        return text if "." in text or "e" in text else f"{text}.0"
    if isinstance(value, tuple):
        return "{" + ", ".join(literal(element) for element in value) + "}"
    if not is_class_name(value):
        raise ValueError(f"'{value}' is not a name in Modelica")
    return value


def wrapper(model: str, changes: Mapping[str, str], libraries: Iterable[str] = ()) -> str:
    """Text of the model `WRAPPER`: *model* with the parameters of dotted names in *changes* given as Modelica texts.

    *libraries* are mentioned, because the front-end reads only libraries whose names stand in a text.
    """
    tree: dict[str, object] = {}
    for path, text in sorted(changes.items()):
        node = tree
        *above, last = path.split(".")
        for part in above:
            inner = node.setdefault(part, {})
            if not isinstance(inner, dict):
                raise TypeError(f"'{path}' is in what is changed as a whole")
            node = inner
        node[last] = text
    mentioned = "".join(f"// {library}\n" for library in libraries)
    return f"{mentioned}model {WRAPPER}\n  extends {model}{_modification(tree)};\nend {WRAPPER};\n"


def _modification(tree: Mapping[str, object]) -> str:
    # As deep as component names have dots, which `is_class_name` has seen.
    if not tree:
        return ""
    parts = (
        f"{name}{_modification(entry) if isinstance(entry, dict) else f'={entry}'}" for name, entry in tree.items()
    )
    return "(" + ", ".join(parts) + ")"
