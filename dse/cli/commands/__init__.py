"""The commands, in the order the help lists them."""

from __future__ import annotations


def register() -> None:
    """Import every command, which adds it to the application."""
    from dse.cli.commands import (  # noqa: F401  # each import registers one command
        build,
        check,
        components,
        enumerate_,
        explore,
        figure,
        init,
        replay,
        report,
        results,
        run,
        simulate,
    )
