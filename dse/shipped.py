"""The folders that come with the program: the example's and the pages about everything."""

from __future__ import annotations

from pathlib import Path

from dse.errors import fail


def content(*folders: str) -> Path:
    """Where *folders* lie: in the installed package, or in the clone it is run from. Raises DseError if nowhere."""
    package = Path(__file__).resolve().parent
    for candidate in (package / "content", package.parent):
        if all((candidate / name).is_dir() for name in folders):
            return candidate
    raise fail(f"{' and '.join(folders)} are missing from this installation", hint="install dse-workbench again")
