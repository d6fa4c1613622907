"""The commands, in the order the help lists them."""

from __future__ import annotations


def register() -> None:
    """Import every command, which adds it to the application."""
    from dse.cli.commands import (  # noqa: F401  # each import registers one command
        init,
        check,
        components,
        build,
        enumerate_,
        simulate,
        run,
        explore,
        results,
        report,
        figure,
        replay,
    )
