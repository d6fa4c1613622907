"""Connections of one signal to elements of several vectors, written as equations.

rumoca 0.10.2 refuses them where the signal is discrete: ``connect(a.y, sum.u[1]); connect(a.y, product.u[2]);``. For
signals, ``sum.u[1] = a.y`` is the same. It is not for pins and flanges, for which the front-end finds too many
equations; so this is done only to sources that it refused for that reason.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from functools import partial

from dse.modelica.frontend.source_text import changed, code

ELEMENTS = "element assignments must cover a discrete coordinate exactly once"
"""What the front-end's refusal of such connections says."""
_PATH = r"[A-Za-z_]\w*(?:\s*\.\s*[A-Za-z_]\w*)*"
_CONNECT = re.compile(
    rf"\bconnect\s*\(\s*(?P<one>{_PATH})(?P<a>\s*\[[\w\s]+\])?\s*,\s*(?P<other>{_PATH})(?P<b>\s*\[[\w\s]+\])?\s*\)"
)


def with_equations(files: Mapping[str, bytes], least: int) -> dict[str, bytes]:
    """*files* with such connections, of signals that have at *least* so many, as equations as long."""
    return changed(files, partial(_changed, least))


def _changed(least: int, text: str) -> str:
    found = [match for match in _CONNECT.finditer(code(text)) if (match["a"] is None) != (match["b"] is None)]
    used = Counter(_signal(match) for match in found)
    for match in reversed(found):
        if used[_signal(match)] >= least:
            element, signal = (
                (match["other"] + match["b"], match["one"])
                if match["b"]
                else (match["one"] + match["a"], match["other"])
            )
            equation = f"{element} = {signal}".ljust(match.end() - match.start())
            text = text[: match.start()] + equation + text[match.end() :]
    return text


def _signal(match: re.Match[str]) -> str:
    return re.sub(r"\s", "", match["one"] if match["b"] else match["other"])
