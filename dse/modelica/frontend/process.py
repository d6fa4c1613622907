"""The front-end in a process of its own, because it may crash, hang or answer nonsense."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

VERSION = "0.10.2"
"""The version of rumoca whose output the reader knows. Another may mean something else by the same words."""

_CHILD = Path(__file__).with_name("child.py")


class FrontEndDied(Exception):  # noqa: N818  # it says what happened
    """The process ended, took too long or answered nonsense; the text completes "the front-end …"."""


class FrontEndRefusal(Exception):  # noqa: N818  # it says what happened
    """The front-end refused the model; the text is its message."""


class FrontEnd(contextlib.AbstractContextManager["FrontEnd"]):
    """A running front-end that sees the files in *folder* and the libraries in *roots*.

    A request that fails by `FrontEndDied` leaves a new process behind, so that the next may succeed.
    """

    def __init__(self, folder: Path, roots: tuple[str, ...], cache: Path, seconds: float = 120.0) -> None:
        self._folder, self._roots, self._cache, self._seconds = folder, roots, cache, seconds
        self._process: subprocess.Popen[str] | None = None

    def __exit__(self, *_: object) -> None:
        self._end()

    def ask(self, request: Mapping[str, object]) -> dict[str, Any]:
        """The answer to one request. Raises FrontEndRefusal and FrontEndDied."""
        if self._process is None:
            self._process = self._start()
            version = self._exchange({"roots": list(self._roots)}).get("version")
            if version != VERSION:
                self._end()
                raise FrontEndDied(f"is rumoca {version}, but only {VERSION} is known")
        return self._exchange(request)

    def _start(self) -> subprocess.Popen[str]:
        # What it finds must not depend on this machine, so neither on its variables nor on its caches.
        hidden = ("MODELICAPATH", "HOME", "XDG_CACHE_HOME", "USERPROFILE", "LOCALAPPDATA", "PYTHONPATH")
        kept = {name: value for name, value in os.environ.items() if name not in hidden}
        places = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "USERPROFILE", "LOCALAPPDATA"), str(self._cache))
        return subprocess.Popen(
            [sys.executable, "-I", str(_CHILD)],
            cwd=self._folder,
            env={**kept, **places, "PYTHONUTF8": "1", "RUST_BACKTRACE": "0"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
            errors="replace",
        )

    def _exchange(self, request: Mapping[str, object]) -> dict[str, Any]:
        process = self._process
        assert process is not None  # noqa: S101  # for the type checker
        assert process.stdin is not None  # noqa: S101  # same
        assert process.stdout is not None  # noqa: S101  # same
        late = threading.Event()

        def stop() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(self._seconds, stop)
        timer.start()
        try:
            with contextlib.suppress(OSError):  # it died before it listened: that shows in the answer
                process.stdin.write(json.dumps(request) + "\n")
                process.stdin.flush()
            line = process.stdout.readline()
        finally:
            timer.cancel()
        if not line.endswith("\n"):
            self._end()
            raise FrontEndDied(
                f"took longer than {self._seconds:g} s" if late.is_set() else "crashed, or wanted more than 4 GiB"
            )
        return self._understood(line)

    def _understood(self, line: str) -> dict[str, Any]:
        try:
            answer = json.loads(line)
        except (ValueError, RecursionError):
            answer = None
        if not isinstance(answer, dict):
            self._end()
            raise FrontEndDied("answered what cannot be read")
        if "error" in answer:
            if answer["error"]["kind"] in ("ImportError", "ModuleNotFoundError"):
                self._end()
                raise FrontEndDied(f"rumoca {VERSION} is not installed")
            if answer["error"]["kind"] == "PanicException":
                self._end()
                raise FrontEndDied("crashed: " + str(answer["error"]["message"]).splitlines()[0][:200])
            raise FrontEndRefusal(str(answer["error"]["message"]))
        return answer

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        process.kill()
        process.wait()
