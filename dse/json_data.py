"""JSON from outside: plain data within bounds, and nouns made of it.

``json.loads`` accepts integers of any length, NaN, infinities, and text that cannot be encoded. Such a value fails far
from the file or socket it was read from: as an OverflowError in a report, or a UnicodeEncodeError in an answer. Here
all of it is one ValueError at the border, which says what is wrong.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import lru_cache
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

MOST_BYTES = 256 * 2**20
_MOST_LEVELS = 64


def read_json(content: str | bytes, *, most: int = MOST_BYTES, only_finite: bool = True) -> Any:
    """The data in a JSON text in UTF-8.

    ValueError for anything else: more than *most* bytes, values nested more than 64 levels deep, numbers beyond the
    range of floats, integers, too, and text with half a surrogate pair; and for NaN and infinities, unless their
    writer may have written them (not *only_finite*).
    """
    raw = content.encode() if isinstance(content, str) else content
    if len(raw) > most:
        raise ValueError(f"it has more than {most} bytes")
    text = raw.decode()
    real, constant = (_finite, _refused) if only_finite else (float, float)
    try:
        data = json.loads(text, parse_int=_whole, parse_float=real, parse_constant=constant)
    except RecursionError:
        raise ValueError(_TOO_DEEP) from None
    if text.count("[") + text.count("{") > _MOST_LEVELS:
        _check_depth(data)
    if "\\u" in text:
        json.dumps(data, ensure_ascii=False).encode()
    return data


def read_noun(data: Any, shape: Any, at: str) -> Any:
    """*data* as a *shape*: a frozen noun, or what its fields are annotated with.

    A Boolean is no number, and an ``int`` has 64 bits. ValueError names the place, from *at*.
    """
    if shape is Any:
        return data
    origin, arguments = get_origin(shape), get_args(shape)
    if origin in (Union, UnionType):
        if (data is None and NoneType in arguments) or type(data) in arguments:
            return data
        return read_noun(data, next(argument for argument in arguments if argument is not NoneType), at)
    if origin is tuple:
        if not isinstance(data, list):
            raise ValueError(f"{at} is not a list")
        return tuple(read_noun(entry, arguments[0], f"{at}[{number}]") for number, entry in enumerate(data))
    if origin is Mapping or is_dataclass(shape):
        if not isinstance(data, Mapping):
            raise ValueError(f"{at} is not an object")
        if origin is Mapping:
            return {key: read_noun(entry, arguments[1], f"{at}.{key[:80]}") for key, entry in data.items()}
        return _noun(data, shape, at)
    fits = isinstance(data, (int, float) if shape is float else shape) and isinstance(data, bool) == (shape is bool)
    is_long = isinstance(data, int) and not -(1 << 63) <= data < 1 << 63
    if not fits or (is_long and shape is int):
        raise ValueError(f"{at} is {json.dumps(data)[:40]}")
    return float(data) if is_long else data  # numpy has no longer integers


_TOO_DEEP = f"its values are nested more than {_MOST_LEVELS} levels deep"
_hints = lru_cache(maxsize=64)(get_type_hints)


def _noun(data: Mapping[str, Any], shape: Any, at: str) -> Any:
    hints = _hints(shape)
    values = {}
    for entry in fields(shape):
        if entry.name in data:
            values[entry.name] = read_noun(data[entry.name], hints[entry.name], f"{at}.{entry.name}")
        elif entry.default is MISSING and entry.default_factory is MISSING:
            raise ValueError(f"{at} has no '{entry.name}'")
    return shape(**values)


def _whole(text: str) -> int:
    _finite(text)
    return int(text)


def _finite(text: str) -> float:
    value = float(text)
    if math.isinf(value):
        raise ValueError(f"the number {text[:20]} is beyond the range of floats")
    return value


def _refused(name: str) -> float:
    raise ValueError(f"{name} is not a number")


def _check_depth(data: Any) -> None:
    level = [data]
    for _ in range(_MOST_LEVELS + 1):
        parts = (part for each in level for part in (each.values() if isinstance(each, dict) else each))
        level = [part for part in parts if isinstance(part, dict | list)]
        if not level:
            return
    raise ValueError(_TOO_DEEP)
