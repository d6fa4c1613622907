"""A line that says what is being waited for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from dse.cli.terminal import console, plain

_PATIENCE = 1.0
"""Seconds before a line says what is being waited for."""


@contextmanager
def status_line() -> Iterator[Callable[[str], None]]:
    """Shows the text it was last given on a terminal's standard error, once the context has lasted a second."""
    screen = console(stderr=True)
    if not screen.is_terminal:
        yield lambda _: None
        return
    from threading import Timer

    from rich.text import Text

    status = screen.status("")
    late = Timer(_PATIENCE, status.start)
    late.start()
    try:
        yield lambda text: status.update(Text(plain(text)))
    finally:
        late.cancel()
        late.join()
        status.stop()
