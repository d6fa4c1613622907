"""A simulation that did not come to its end."""

from __future__ import annotations


class RunFailed(Exception):  # noqa: N818  # says what happened to the run; a failed run is a result, not a bug
    """A run stopped: *element* is the FMU at fault, *call* the FMI function, *time* in seconds or None before t = 0.

    *what* says what happened, *log* holds the last lines the FMU logged. After a *fatal* failure the FMU must not be
    called again in this process. Instances can be pickled.
    """

    def __init__(
        self, element: str, call: str, time: float | None, log: tuple[str, ...], what: str, fatal: bool = False
    ) -> None:
        super().__init__(element, call, time, log, what, fatal)
        self.element = element
        self.call = call
        self.time = time
        self.log = log
        self.what = what
        self.fatal = fatal

    def __str__(self) -> str:
        return ": ".join([self.what, "; ".join(self.log)]) if self.log else self.what


def place(element: str, call: str, time: float | None) -> str:
    """Where a simulation is, in words: ``world: fmi2DoStep at t = 3.21 s``."""
    return f"{element}: {call}" if time is None else f"{element}: {call} {moment(time)}"


def moment(time: float) -> str:
    """A point in simulated time in words: ``at t = 3.21 s``."""
    return f"at t = {time:.10g} s"
