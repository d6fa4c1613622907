"""A first run of a model whose code nobody knows yet, in a process of its own."""

from __future__ import annotations

import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from dse.errors import Location, fail
from dse.formats import shown
from dse.json_data import read_json, read_noun
from dse.scratch import ScratchFolder
from dse.simulink.generated_model import build_library
from dse.simulink.glue import CodedModel

_CHILD = Path(__file__).with_name("child.py")
_STEPS = 10
_LONGEST = 20.0
"""Seconds for the start and the steps."""


@dataclass(frozen=True, slots=True)
class Trial:
    """What a model begins with: *parameters* after its start, in the interface's order, also infinite ones.

    *error* is what it says of itself, if any.
    """

    parameters: tuple[float, ...]
    error: str


def try_model(model: CodedModel, *, cache: Path | None = None) -> Trial:
    """Start the *model* with its own values and take some steps with all inputs 0.

    Raises DseError: it does not compile, crashes or does not come back.
    """
    made, where = model.interface, Location(shown(model.folder.path))
    library = build_library(model, cache=cache)
    counts = (len(made.parameters), len(made.inputs), len(made.outputs), _STEPS)
    with ScratchFolder() as scratch:
        file = Path(scratch) / "model.so"
        file.write_bytes(library)
        command = [sys.executable, "-I", "-S", str(_CHILD), str(file), *map(str, counts)]
        try:
            done = subprocess.run(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,  # it may print without end
                check=False,
                timeout=_LONGEST,
                cwd=scratch,
            )
        except subprocess.TimeoutExpired:
            what = f"'{model.folder.model}' does not come back from its start and {_STEPS} steps within {_LONGEST:g} s"
            raise fail(what, where) from None
    if done.returncode:
        raise fail(f"'{model.folder.model}' {_ended(done.returncode)} in its start or first {_STEPS} steps", where)
    try:
        trial: Trial = read_noun(read_json(done.stdout, only_finite=False), Trial, "answer")
    except ValueError:
        raise fail(f"'{model.folder.model}' ended the process that ran it", where) from None
    return trial


def _ended(code: int) -> str:
    if code < 0:
        return f"crashed ({signal.Signals(-code).name})"
    return f"ended the process that ran it with {code}"
