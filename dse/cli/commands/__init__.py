"""The commands, in the order the help lists them."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module

COMMANDS = (
    "demo",
    "init",
    "check",
    "list_",
    "new",
    "components",
    "build",
    "probe",
    "enumerate_",
    "space.count",
    "space.constraints",
    "space.choices",
    "space.conflict",
    "space.explain",
    "space.best",
    "space.compare",
    "space.offer",
    "space.graph",
    "space.refine",
    "import_",
    "export",
    "simulate",
    "run",
    "explore",
    "world",
    "status",
    "merge",
    "results",
    "findings",
    "best",
    "rate",
    "verify",
    "refine",
    "compare",
    "compare_components",
    "report",
    "serve",
    "mcp",
    "trust",
    "drive",
    "udp",
    "figure",
    "replay",
    "drives",
    "cache",
    "docs",
    "schema",
)


def register(words: Sequence[str] = ()) -> None:
    """Import the command that *words*, as they were typed, start with, which adds it to the application; else all."""
    first, second = (word.replace("-", "_") for word in (*words[:2], "", "")[:2])
    asked = {first, f"{first}_", f"{first}.{second}"} & {*COMMANDS}
    for name in asked or COMMANDS:
        import_module(f"{__name__}.{name}")
