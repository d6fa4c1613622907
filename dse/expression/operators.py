"""The operators of the expression language, from weakest to strongest, and how they group.

What they compute depends on the numbers: exact fractions (`dse.space.language.arithmetic`), bounds of fractions
(`dse.space.language.intervals`) or waveforms (`dse.metrics.compiler`).
"""

from __future__ import annotations

from collections.abc import Mapping

LOGIC = ("iff", "implies", "or", "xor", "and")
ORDER = ("<", "<=", ">", ">=")
COMPARISON_OPERATORS = (*ORDER, "==", "!=")

FROM_THE_RIGHT = ("implies", "^")
"""``a ^ b ^ c`` is ``a ^ (b ^ c)``."""

ASSOCIATIVE = ("and", "or", "+", "*")

_LEVELS = (
    *((word,) for word in LOGIC),
    ("not",),
    (*COMPARISON_OPERATORS, "between", "is", "in", "="),
    ("+", "-"),
    ("*", "/"),
    ("negative",),
    ("^",),
    ("atom",),
)
STRENGTH: Mapping[str, int] = {word: level for level, words in enumerate(_LEVELS, 1) for word in words}
"""How strongly each binds; ``negative`` is the minus before a value, ``atom`` is a value."""
