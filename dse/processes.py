"""Starting processes of our own without what the one that starts them happens to be."""

from __future__ import annotations

import sys
from multiprocessing.process import BaseProcess
from types import ModuleType


def start_process(process: BaseProcess) -> None:
    """Start *process* without the parent's main module, which spawn would otherwise import again in the child.

    A console script would cost each child the whole command line, and a script without a main guard would do again
    what it did to start it.
    """
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        process.start()
    finally:
        sys.modules["__main__"] = main
