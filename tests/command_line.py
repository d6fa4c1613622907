"""``dse`` as a user runs it, in a process of its own for each command, but without a second of imports for each.

A process that has imported what earlier commands needed, and knows the units, forks one for every command. What a fresh
process imports, and how it starts, are tested with fresh ones. Where there is no safe fork, each command is one.
"""

from __future__ import annotations

import atexit
import gc
import json
import os
import subprocess
import sys
import threading
from functools import cache
from pathlib import Path
from typing import NoReturn

_LONGEST = 300
_START = {"PYTHONUTF8": "0", "LC_ALL": "C", "COLUMNS": "100"}


def run_dse(
    folder: Path, *arguments: str, cache: Path, longest: int = _LONGEST, **more: str
) -> subprocess.CompletedProcess[str]:
    """What ``dse ARGUMENTS`` prints and returns in *folder*; it ends with a signal after *longest* seconds.

    *more* of the environment can name a library in LD_PRELOAD; if that has ``faults_arm``, it is told when the command
    begins, with the file that DSE_TESTS_FAULTS names (tests/faults/shim.c).
    """
    environment = {**os.environ, **_START, "DSE_CACHE": str(cache), **more}
    if sys.platform != "linux":
        command = [sys.executable, "-m", "dse", *arguments]
        return subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False, timeout=longest
        )
    import tempfile

    with tempfile.TemporaryDirectory() as scratch:
        outputs = [Path(scratch, "out"), Path(scratch, "err")]
        job = {"folder": str(folder), "arguments": arguments, "environment": environment, "scratch": scratch}
        server = _server(more.get("LD_PRELOAD", ""), threading.get_ident())
        assert server.stdin
        assert server.stdout
        server.stdin.write(json.dumps({**job, "longest": longest}) + "\n")
        server.stdin.flush()
        code = int(server.stdout.readline())
        out, err = (path.read_bytes().decode("utf-8").replace("\r\n", "\n") for path in outputs)
    return subprocess.CompletedProcess(["dse", *arguments], code, out, err)


@cache
def _server(preload: str, _thread: int) -> subprocess.Popen[str]:
    """One a thread, as it does one job after the other."""
    environment = {**os.environ, **_START} | ({"LD_PRELOAD": preload} if preload else {})
    pipe = subprocess.PIPE
    started = subprocess.Popen([sys.executable, __file__], env=environment, stdin=pipe, stdout=pipe, encoding="utf-8")
    atexit.register(_stop, started)
    return started


def _stop(server: subprocess.Popen[str]) -> None:
    server.communicate()  # closes its input, at which it ends


def _serve() -> None:
    """Fork for each job."""
    from dse.units import parse_unit

    sys.path.pop(0)  # this folder
    parse_unit("m")  # reads the definitions of all units
    jobs, answers = os.fdopen(os.dup(0), encoding="utf-8"), os.fdopen(os.dup(1), "w", encoding="utf-8")
    while line := jobs.readline():
        job = json.loads(line)
        gc.freeze()  # a command need not look through what it did not make, which would copy it
        child = os.fork()
        if child == 0:
            _be_dse(**job)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        _import_what_was_needed(Path(job["scratch"], "modules"))
        answers.write(f"{code}\n")
        answers.flush()


def _be_dse(folder: str, arguments: list[str], environment: dict[str, str], scratch: str, longest: int) -> NoReturn:
    import ctypes
    import signal
    from importlib import import_module

    before = set(sys.modules)
    flags = os.O_WRONLY | os.O_CREAT
    for number, path in ((0, os.devnull), (1, f"{scratch}/out"), (2, f"{scratch}/err")):
        os.dup2(os.open(path, flags if number else os.O_RDONLY), number)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["dse", *arguments]
    sys.path[:0] = [folder, *environment.get("PYTHONPATH", "").split(os.pathsep)]  # as python -m does
    signal.alarm(longest)
    # Workers of a study import the main module again, by its name.
    sys.modules["__main__"] = module = import_module("dse.__main__")
    faults = environment.get("DSE_TESTS_FAULTS", "")
    code: object = None
    try:
        if faults:
            ctypes.CDLL(None).faults_arm(faults.encode())
        module.main()
    except SystemExit as end:
        code = end.code
    finally:
        if faults:
            ctypes.CDLL(None).faults_disarm()
        needed = [name for name in sys.modules if name not in before and name != "dse.__main__"]
        Path(scratch, "modules").write_text("\n".join(needed), encoding="utf-8")
    if faults:
        sys.exit(code)
    _end(code)


def _end(code: object) -> NoReturn:
    """End as every Python does, but do not tear down module by module what was imported for all commands."""
    assert code is None or isinstance(code, int)
    threading._shutdown()
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code or 0)


def _import_what_was_needed(listed: Path) -> None:
    from importlib import import_module

    for name in listed.read_text(encoding="utf-8").split() if listed.exists() else ():
        if name not in sys.modules and not name.startswith(("__", "_distutils")):
            try:
                import_module(name)
            except Exception:  # noqa: BLE001, S112  # some modules only come with others
                continue


if __name__ == "__main__":
    _serve()
