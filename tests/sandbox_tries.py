"""What a process tries in a sandbox, importable by a process that has imported nothing else."""

from __future__ import annotations

import json
import os
import socket
import subprocess
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from dse.errors import DseError
from dse.sandbox import abi


def has_sandbox() -> bool:
    """Whether this machine has one."""
    with suppress(DseError):
        return bool(abi())
    return False


def try_all(own: Path, home: Path) -> None:
    """Write what could be done into the file ``said`` in *own*."""
    tries: dict[str, Callable[[], object]] = {
        "own": lambda: (own / "made").write_text("mine"),
        "move": lambda: (own / "made").rename(own / "moved"),
        "temporary": lambda: Path(os.environ["TMPDIR"], "folder").mkdir(),
        "program": lambda: subprocess.run(["/bin/sh", "-c", "exit 0"], check=True),
        "write": lambda: (home / "new").write_text("mine"),
        "remove": (home / "kept").unlink,
        "truncate": lambda: os.truncate(home / "kept", 0),
        "empty": lambda: os.open(home / "kept", os.O_RDONLY | os.O_TRUNC),
        "empty with no right": lambda: os.open(home / "kept", 3 | os.O_TRUNC),
        "move out": lambda: (own / "moved").rename(home / "moved"),
        "link in": lambda: os.link(home / "kept", own / "kept"),
        "symbolic link": lambda: (own / "link").symlink_to(home / "kept"),
        "pipe": lambda: os.mkfifo(own / "pipe"),
        "read": (home / "kept").read_text,
        "look": lambda: list(home.iterdir()),
        "program that writes": lambda: subprocess.run(["/bin/sh", "-c", f"echo > {home}/new"], check=True),
        "socket": lambda: socket.socket(socket.AF_UNIX),
        "watch": lambda: _watch(home),
        "supervisor": lambda: Path(f"/proc/{os.getppid()}/environ").read_bytes(),
    }
    done = []
    for name, attempt in tries.items():
        with suppress(OSError, subprocess.SubprocessError):
            attempt()
            done.append(name)
    (own / "said").write_text(json.dumps(done))


def _watch(folder: Path) -> None:
    """Ask to be told of what happens in *folder*."""
    import ctypes

    system = ctypes.CDLL(None)
    if system.inotify_add_watch(system.inotify_init1(os.O_CLOEXEC), os.fsencode(folder), 0x100) < 0:
        raise OSError(ctypes.get_errno(), "inotify_add_watch")


OWN = ["own", "move", "temporary", "program"]
