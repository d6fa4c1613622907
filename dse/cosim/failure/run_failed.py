"""A simulation that did not come to its end."""

from __future__ import annotations


class RunFailed(Exception):  # noqa: N818  # says what happened to the run; a failed run is a result, not a bug
    """A run stopped: *element* is the FMU at fault, *call* the FMI function, *time* in seconds or None before t = 0.

    *what* says what happened, *log* holds the last lines the FMU logged. After a *fatal* failure the FMU must not be
    called again in this process. Instances can be pickled.
    """

    def __init__(
        self,
        element: str,
        what: str,
        call: str = "",
        time: float | None = None,
        log: tuple[str, ...] = (),
        fatal: bool = False,
    ) -> None:
        super().__init__(element, what, call, time, log, fatal)
        self.element = element
        self.what = what
        self.call = call
        self.time = time
        self.log = log
        self.fatal = fatal

    def __str__(self) -> str:
        return ": ".join([self.what, "; ".join(self.log)]) if self.log else self.what
