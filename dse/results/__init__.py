"""The study folder: its tables, its waveforms, what is written of them for others.

The front door's function ``dse.results("out/gains")`` has the name of this room, and importing anything from the room
binds that name to it. So the room can be called, and calls the function.
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any


class _Room(ModuleType):
    def __call__(self, folder: str | Path) -> Any:
        # By name: the layers below do not import the front door.
        return import_module("dse.api.results").results(folder)


sys.modules[__name__].__class__ = _Room
