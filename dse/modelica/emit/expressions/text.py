"""Numbers and strings as C has them."""

from __future__ import annotations

import math


def literal(value: float) -> str:
    """*value* to the last bit, as an operand: ``2.5``, ``(-1e-09)``, ``NAN``."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "(-INFINITY)"
    shown = repr(value)
    return f"({shown})" if shown.startswith("-") else shown


def quoted(text: str) -> str:
    """*text* as a C string in plain ASCII; everything else in UTF-8, as octal escapes."""
    return '"' + "".join(_ESCAPES.get(byte) or _plain(byte) for byte in text.encode("utf-8")) + '"'


# A question mark is escaped because of trigraphs.
_ESCAPES = {ord('"'): '\\"', ord("\\"): "\\\\", ord("\n"): "\\n", ord("\t"): "\\t", ord("?"): "\\?"}


def _plain(byte: int) -> str:
    return chr(byte) if 32 <= byte < 127 else f"\\{byte:03o}"


def comment(text: str) -> str:
    """*text* as a comment of one line, whatever it contains."""
    plain = text.encode("ascii", "replace").decode().replace("\n", " ").replace("\\", "/")
    return f"/* {plain.replace('*/', '* /').replace('/*', '/ *')} */"


_WIDTH = 110


def table(declaration: str, items: list[str], empty: str = "0") -> list[str]:
    """An array's definition; C knows no empty array, so that one gets an element nobody reads."""
    lines = [f"{declaration} = {{"]
    line = ""
    for item in items or [empty]:
        if line and len(line) + len(item) + 6 > _WIDTH:
            lines.append(f"    {line.rstrip()}")
            line = ""
        line += f"{item}, "
    return [*lines, f"    {line.rstrip()}", "};"]
