"""What the text of a model's code tells of its blocks: their names in comments, and which ports it writes."""

from __future__ import annotations

import re
from collections.abc import Mapping

from dse.simulink.written_variables import written

_SYSTEM = re.compile(r"'(<(?:Root|S\d+)>)'\s*:\s*'([^'\n]+)'")
_PORT = re.compile(r"'<Root>/[^']+'")
_TOLD = re.compile(rf"(Inport|Outport): ({_PORT.pattern})")
_BLOCK = re.compile(r"'(<(?:Root|S\d+)>)/([^'\n]+)'")


def systems(header: str) -> dict[str, str]:
    """The paths of the model's systems by their marks (``<S1>``), from the text of its header."""
    return dict(_SYSTEM.findall(header))


def block_of(comment: str, known: Mapping[str, str]) -> str:
    """The first block a comment names, with its path where its system is *known*; "" if it names none."""
    found = _BLOCK.search(comment)
    if found is None:
        return ""
    system = known.get(found[1], "" if found[1] == "<Root>" else found[1])
    return f"{system}/{found[2]}".removeprefix("/")


class Writing:
    """Which variables a model's *code* writes, but for functions that only set them to zero at first."""

    def __init__(self, code: str) -> None:
        self._told = set(_TOLD.findall(code))
        self._written = written(code)

    def of(self, name: str, comment: str) -> bool:
        """Whether *name*, which has that *comment*, is written.

        The code's comments may say where the model's port is; else that anything is assigned to it, to one of its
        members or elements, or copied there.
        """
        port = _PORT.search(comment)
        says = [(kind, port[0]) in self._told for kind in ("Inport", "Outport")] if port else [False, False]
        if any(says) and not all(says):
            return says[1]
        return name in self._written
