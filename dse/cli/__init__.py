"""One file per command; nothing else prints or exits."""

from dse.cli.entry import main

__all__ = ["main"]
