"""What a process has only one of, and an FMU may change: it is put back after every run."""

from __future__ import annotations

import locale
import os
import signal
import sys


class ProcessState:
    """The working folder, the locale and the permissions of new files as they are now; and no timer runs."""

    def __init__(self) -> None:
        self._folder = _folder()
        self._locale = locale.setlocale(locale.LC_ALL)
        self._umask = os.umask(0o077)
        os.umask(self._umask)

    def restore(self) -> None:
        """Make them so again; later runs would find other files, read other numbers, or die of an alarm."""
        if _folder() != self._folder:
            os.chdir(self._folder)
        if locale.setlocale(locale.LC_ALL) != self._locale:
            locale.setlocale(locale.LC_ALL, self._locale)
        os.umask(self._umask)
        if sys.platform != "win32":
            for timer in (signal.ITIMER_REAL, signal.ITIMER_VIRTUAL, signal.ITIMER_PROF):
                signal.setitimer(timer, 0)


def _folder() -> str:
    try:
        return os.getcwd()  # noqa: PTH109  # asked after every run
    except FileNotFoundError:
        return ""  # it was deleted
