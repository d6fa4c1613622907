"""Starting processes of our own without what the one that starts them happens to be."""

from __future__ import annotations

import os
import signal
import sys
import sysconfig
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from multiprocessing import current_process, get_start_method, resource_tracker, set_start_method
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import psutil

_FOR_NUMPY = {"OPENBLAS_NUM_THREADS": "1"}
_TO_START = {"PYTHONSAFEPATH": "1", **_FOR_NUMPY}
"""What a new process has in its environment until `forget_start`, unless the user gives it something else."""
_ADDED = "DSE_ADDED_TO_START"

_ENDING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]

_one_at_a_time = threading.Lock()

_runs_command = False


def mark_command() -> None:
    """This process runs a command of dse and nothing else: a program that uses dse may have threads and locks."""
    global _runs_command  # noqa: PLW0603  # a process has one
    _runs_command = True


def can_be_copied() -> bool:
    """Whether a child can be a copy of this process (fork), which has imported already what the child would.

    Other threads than timers may hold a lock, and OpenMP works in no copy of a process that has used it.
    """
    if sys.platform != "linux" or not _runs_command:
        return False
    others = (thread for thread in threading.enumerate() if thread is not threading.main_thread())
    if not all(isinstance(each, threading.Timer) for each in others):
        return False
    loaded = Path("/proc/self/maps").read_bytes()
    return not any(library in loaded for library in _OPENMP)


_OPENMP = (b"libgomp", b"libomp", b"libiomp")


def open_files() -> list[int]:
    """The numbers of the files that this process has open, standard streams aside; on Linux."""
    numbers = [int(name) for name in os.listdir("/proc/self/fd")]  # noqa: PTH208  # numbers, not paths
    return [number for number in numbers if number > _STANDARD]


_STANDARD = 2


def start_process(process: BaseProcess, log: Path | None = None) -> None:
    """Start *process*, as `unburdened`. Signals that end programs wait there until it calls `forget_start`.

    What it says before it prints elsewhere by itself goes to *log*.
    """
    with unburdened(), _somewhere():
        if sys.platform != "win32":
            resource_tracker.ensure_running()  # at its start it would let signals through
        with _signals_waiting(), _printing_to(log) if log else nullcontext():
            process.start()


def start_copy(process: BaseProcess) -> None:
    """Start *process*, which is a copy of this one: see `can_be_copied`. Signals that end programs wait there, too."""
    with unburdened(), _signals_waiting():
        process.start()


class Family:
    """The process with the number *pid*, and all that it and its children have started: that is looked up now and then.

    An FMU may have a process of its own do its work.
    """

    def __init__(self, pid: int) -> None:
        import psutil

        self._first = psutil.Process(pid)
        self._others: list[psutil.Process] = []
        self._looked = -_LOOK_EVERY

    def resident(self) -> int:
        """Bytes of memory they hold together. Raises psutil.Error if the first is no more."""
        import psutil

        total = int(self._first.memory_info().rss)
        if time.monotonic() - self._looked >= _LOOK_EVERY:
            self._looked, self._others = time.monotonic(), []
            for pid in descendants(self._first.pid):
                with suppress(psutil.Error):
                    self._others.append(psutil.Process(pid))
        for other in self._others:
            with suppress(psutil.Error):
                total += other.memory_info().rss
        return total


_LOOK_EVERY = 1.0


def descendants(pid: int) -> list[int]:
    """The processes that *pid* has started, that these have started, and so on.

    Raises psutil.Error if *pid* is no more and the system is none that lists the children of a thread, as Linux does.
    """
    if not Path("/proc/thread-self/children").exists():
        import psutil

        # Looks through every process there is, which takes a supervisor milliseconds each second.
        return [process.pid for process in psutil.Process(pid).children(recursive=True)]
    found = [pid]
    for each in found:  # which gets longer on the way
        with suppress(OSError):  # it has ended
            for thread in Path(f"/proc/{each}/task").iterdir():
                with suppress(OSError):
                    found += map(int, (thread / "children").read_bytes().split())
    return found[1:]


@contextmanager
def unburdened() -> Iterator[None]:
    """Processes are started without this one's main module, which spawn would otherwise import again in the child.

    A console script would cost each child the whole command line, and a script without a main guard would do again
    what it did to start it. Nor do they find modules in the current folder: whatever lies there would be taken for the
    standard library's, and run. numpy makes no threads for linear algebra there, a quarter of what importing it
    takes with two processors. What is started calls `forget_start`.
    """
    with _one_at_a_time, _as_parent():
        main, path = sys.modules["__main__"], sys.path
        added = [name for name in _TO_START if not os.environ.get(name)]
        sys.path = path_without_here()
        sys.modules["__main__"] = ModuleType("__main__")
        os.environ.update({name: _TO_START[name] for name in added}, **{_ADDED: " ".join(added)})
        try:
            yield
        finally:
            sys.modules["__main__"], sys.path = main, path
            _take_away(_ADDED, *added)


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


def forget_start() -> None:
    """What was changed for the start of this process is no business of the programs that an FMU may start.

    To be called when signals are handled as they shall be.
    """
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDING)
    _take_away(_ADDED, *os.environ.get(_ADDED, "").split())


def import_numpy() -> None:
    """Import numpy as in a worker: without threads for linear algebra."""
    with _one_at_a_time:
        added = [name for name in _FOR_NUMPY if not os.environ.get(name)]
        os.environ.update({name: _FOR_NUMPY[name] for name in added})
        try:
            import numpy  # noqa: F401, ICN001
        finally:
            _take_away(*added)


def _take_away(*names: str) -> None:
    for name in names:
        os.environ.pop(name, None)


def path_without_here() -> list[str]:
    """``sys.path`` without the current folder, unless PYTHONPATH names it or it was installed.

    What the user's script has beside it and dse itself are found last of all.
    """
    here = _here()
    standard = sysconfig.get_path("stdlib")
    before = sys.path.index(standard) if standard in sys.path else len(sys.path)
    named = {os.path.realpath(entry) for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry}
    kept = [
        entry
        for place, entry in enumerate(sys.path)
        if entry and not (place < before and os.path.realpath(entry) == here and here not in named)
    ]
    main = sys.modules["__main__"]
    script = getattr(main, "__file__", None) if main.__spec__ is None else None
    last = [str(Path(__file__).parents[1]), *([str(Path(script).resolve().parent)] if script else [])]
    return kept + [entry for entry in last if entry not in kept]


def _here() -> str:
    try:
        return os.path.realpath(Path.cwd())
    except OSError:
        return ""


@contextmanager
def _signals_waiting() -> Iterator[None]:
    """Ctrl-C reaches the new process, too: while it imports it would say so with a traceback."""
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _ENDING)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _printing_to(log: Path) -> Iterator[None]:
    """Standard error is *log*, for a moment: a child that dies of its first imports must not speak on the terminal."""
    try:
        kept = os.dup(2)
    except OSError:  # it is closed
        yield
        return
    try:
        file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        os.dup2(file, 2)
        os.close(file)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


@contextmanager
def _somewhere() -> Iterator[None]:
    """Be in a folder that exists: the current one may have been deleted, which a start would not survive."""
    if _here():
        yield
        return
    nowhere = os.open(".", os.O_RDONLY)
    try:
        os.chdir(tempfile.gettempdir())
        yield
    finally:
        with suppress(OSError):
            os.fchdir(nowhere)
        os.close(nowhere)
