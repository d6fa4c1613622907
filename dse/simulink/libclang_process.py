"""libclang, asked in a process of its own: what it reads may crash it, keep it busy or fill the memory."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from dse.cache import content_key
from dse.errors import Location, fail
from dse.json_data import read_json
from dse.scratch import ScratchFolder

_PARSING = Path(__file__).with_name("parsing.py")
_SECONDS = 90.0
"""A child ends itself after a minute of work; one that waits for what it opened does not work."""


@lru_cache(maxsize=1)
def identity() -> str:
    """What reads, for keys of the cache: libclang's version and our reader. Raises DseError if it is not installed."""
    _package()
    versions = [each.version for each in importlib.metadata.distributions(name="libclang")]
    return " ".join([*versions, content_key([("parsing", _PARSING.read_bytes())])])


def asked(request: Mapping[str, object], where: Location) -> dict[str, Any]:
    """The answer to a request (parsing.py). Raises DseError at *where* if there is none."""
    hidden = ("CPATH", "C_INCLUDE_PATH", "CPLUS_INCLUDE_PATH", "PYTHONPATH")
    environment = {name: value for name, value in os.environ.items() if name not in hidden}
    with ScratchFolder() as folder:
        whole = json.dumps({**request, "clang": _package()})
        try:
            done = subprocess.run(
                [sys.executable, "-I", str(_PARSING)],
                input=whole.encode(),
                cwd=folder,  # what lies in it would be found before what the options name
                env={**environment, "PYTHONUTF8": "1", "TMPDIR": str(folder)},
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                timeout=_SECONDS,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise _unread(where, f"it took longer than {_SECONDS:g} s") from None
    try:
        return dict(read_json(done.stdout))
    except (ValueError, TypeError):
        raise _unread(where, "libclang crashed, or wanted more than a minute or 4 GiB") from None


def _package() -> str:
    """The folder in which the package lies."""
    found = importlib.util.find_spec("clang")
    if found is None or not found.submodule_search_locations:
        what = "reading C code that Simulink generated needs libclang, which is not installed"
        raise fail(what, hint='pip install "dse-workbench[simulink]"')
    return str(Path(next(iter(found.submodule_search_locations))).parent)


def _unread(where: Location, why: str) -> Exception:
    return fail(f"what it declares cannot be read: {why}", where, "is it as the coder wrote it?")
