"""One file per command; nothing else prints or exits."""

from dse.cli.app import main

__all__ = ["main"]
