"""An insight as the page reads it: its fields as they are called, arrays beside it in the block of numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from dse.report.content.insight import Insight
from dse.report.page.encoding import Block

_KINDS = {"float32": "f4", "uint8": "u1"}


def insight_json(insight: Insight, block: Block) -> Any:
    """Plain data; an array is ``{"array": its name in *block*}``. Numbers have six digits, what is none is null."""
    return _plain(insight, "insight", block)


def _plain(value: Any, place: str, block: Block) -> Any:
    if is_dataclass(value):
        return {each.name: _plain(getattr(value, each.name), f"{place}.{each.name}", block) for each in fields(value)}
    if isinstance(value, tuple | list):
        return [_plain(each, f"{place}.{index}", block) for index, each in enumerate(value)]
    if isinstance(value, np.ndarray):
        block.add(place, _KINDS[value.dtype.name], value)
        return {"array": place}
    if isinstance(value, float):
        return float(f"{value:.6g}") if math.isfinite(value) else None
    if isinstance(value, Mapping):
        raise TypeError(f"{place} is a mapping, which has no order that the page could rely on")
    return str(value) if isinstance(value, str) else value
