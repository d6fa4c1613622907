"""The commands, in the order the help lists them."""

from __future__ import annotations

from importlib import import_module

COMMANDS = (
    "init",
    "check",
    "components",
    "build",
    "probe",
    "enumerate_",
    "space_count",
    "space_constraints",
    "space_choices",
    "space_conflict",
    "space_explain",
    "space_best",
    "space_compare",
    "space_graph",
    "space_refine",
    "import_",
    "export",
    "simulate",
    "run",
    "explore",
    "results",
    "report",
    "figure",
    "replay",
    "docs",
)


def register() -> None:
    """Import every command, which adds it to the application."""
    for name in COMMANDS:
        import_module(f"{__name__}.{name}")
