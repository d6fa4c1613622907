"""Starting processes of our own without what the one that starts them happens to be."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import current_process, get_start_method, set_start_method
from multiprocessing.process import BaseProcess
from types import ModuleType

_one_at_a_time = threading.Lock()


def start_process(process: BaseProcess) -> None:
    """Start *process* without the parent's main module, which spawn would otherwise import again in the child.

    A console script would cost each child the whole command line, and a script without a main guard would do again
    what it did to start it.
    """
    with _one_at_a_time, _as_parent():
        main = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            process.start()
        finally:
            sys.modules["__main__"] = main


@contextmanager
def _as_parent() -> Iterator[None]:
    """Be a process that may have children, also as the worker of another package."""
    # Dask's are daemons, to which multiprocessing forbids it: they would leave theirs behind. Ours leave by themselves.
    settings = getattr(current_process(), "_config", {})
    daemon = settings.pop("daemon", None)
    # A child of loky's would be told to start others in loky's way, of which it knows nothing.
    method = get_start_method(allow_none=True)
    set_start_method("spawn", force=True)
    try:
        yield
    finally:
        set_start_method(method, force=True)
        if daemon is not None:
            settings["daemon"] = daemon
