"""What a process has only one of, and an FMU may change: it is put back after every run."""

from __future__ import annotations

import locale
import os


class Surroundings:
    """The working folder and the locale as they are now."""

    def __init__(self) -> None:
        self._folder = _folder()
        self._locale = locale.setlocale(locale.LC_ALL)

    def restore(self) -> None:
        """Make them so again; later runs would find other files, or other numbers in the same text."""
        if _folder() != self._folder:
            os.chdir(self._folder)
        if locale.setlocale(locale.LC_ALL) != self._locale:
            locale.setlocale(locale.LC_ALL, self._locale)


def _folder() -> str:
    try:
        return os.getcwd()  # noqa: PTH109  # asked after every run
    except FileNotFoundError:
        return ""  # it was deleted
