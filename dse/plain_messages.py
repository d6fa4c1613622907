"""Messages from a process that runs FMUs, as bytes that can do no harm: an FMU can write what that process can write.

Numbers, text, bytes, arrays of numbers, mappings, tuples (what was a list comes as one, too), and frozen dataclasses of
those; nothing in them is a name of something to call, as it would be in a pickle.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from dse.json_data import read_json

_LENGTH = struct.Struct("=Q")


def packed(message: object) -> bytes:
    """*message* as bytes. TypeError if it holds anything else than a message may."""
    blobs = bytearray()
    head = json.dumps(_tree(message, blobs)).encode()
    return b"".join((_LENGTH.pack(len(head)), head, blobs))


def unpacked(content: bytes, *classes: type) -> Any:
    """What was packed; dataclasses can only be *classes*. Raises ValueError for anything that is no such message."""
    try:
        (length,) = _LENGTH.unpack_from(content)
        begin = _LENGTH.size + length
        tree = read_json(content[_LENGTH.size : begin], only_finite=False)
        return _message(tree, memoryview(content)[begin:], {each.__name__: each for each in classes})
    except Exception as error:  # whatever a stranger's bytes lead to
        raise ValueError(f"no message: {error}") from error


def _tree(message: object, blobs: bytearray) -> object:
    if message is None or isinstance(message, str | float | int):
        return message
    if isinstance(message, bytes):
        return {"bytes": _kept(message, blobs)}
    if isinstance(message, np.ndarray):
        return {"array": [*_kept(message.tobytes(), blobs), message.dtype.str, message.shape]}
    if isinstance(message, Mapping):
        return {"mapping": [[_tree(key, blobs), _tree(value, blobs)] for key, value in message.items()]}
    if isinstance(message, Sequence):
        return [_tree(each, blobs) for each in message]
    if is_dataclass(message) and not isinstance(message, type):
        return {type(message).__name__: [_tree(getattr(message, field.name), blobs) for field in fields(message)]}
    raise TypeError(f"{type(message).__name__} is not a part of a message")


def _kept(content: bytes, blobs: bytearray) -> list[int]:
    begin = len(blobs)
    blobs.extend(content)
    return [begin, len(content)]


def _message(tree: Any, blobs: memoryview, classes: Mapping[str, type]) -> Any:
    if isinstance(tree, list):
        return tuple(_message(each, blobs, classes) for each in tree)
    if not isinstance(tree, dict):
        return tree
    ((kind, parts),) = tree.items()
    if kind == "mapping":
        return {_message(key, blobs, classes): _message(value, blobs, classes) for key, value in parts}
    if kind in ("bytes", "array"):
        begin, length, *form = parts
        if not 0 <= begin <= begin + length <= len(blobs):
            raise ValueError("cut short")
        content = bytes(blobs[begin : begin + length])
        return np.frombuffer(content, _numeric(form[0])).reshape(form[1]) if form else content
    return classes[kind](*_message(parts, blobs, classes))


def _numeric(name: str) -> np.dtype[Any]:
    kind = np.dtype(name)
    if kind.kind not in "biufS":
        raise ValueError("no array of numbers")
    return kind
