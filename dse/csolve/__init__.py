"""The C that the FMUs we make and the co-simulation kernel share: the solvers, and what a fused loop is told.

It is included as ``"csolve/….h"``, below ``INCLUDE``; an FMU carries what it needs of it in its sources.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

FOLDER = Path(__file__).parent
"""Where the headers lie."""

INCLUDE = FOLDER.parent
"""The folder a compiler has to look in."""


def headers() -> dict[str, bytes]:
    """All of them, by the name they are included with."""
    return {f"csolve/{path.name}": path.read_bytes() for path in sorted(FOLDER.glob("*.h"))}


def fingerprint(folders: Iterable[Path]) -> str:
    """Names the content of the C in *folders*: of the kernel's, what it was compiled from and what lies here."""
    digest = hashlib.sha256()
    for path in (path for folder in folders for path in sorted(folder.glob("*.[ch]"))):
        content = path.read_bytes()
        digest.update(f"{path.name} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:32]
