"""A simulation that did not come to its end."""

from __future__ import annotations

from enum import IntEnum


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


# Why the kernel stops.


class StopReason(IntEnum):
    """Numbered as in kernel.h, from CHATTERS on as in exchange_memory.h."""

    BAD_STATUS = 1
    NO_INSTANCE = 2
    NOT_SETTLED = 3
    NOT_FINITE = 4
    TOO_LARGE = 5
    UNFIT_START = 6
    UNFIT_INPUT = 7
    STEP_CUT_SHORT = 8
    NO_ITEM = 9
    NO_ITEM_START = 10
    NO_ITEM_INPUT = 11
    NO_TEXT = 12
    LONG_TEXT = 13
    ENDLESS_EVENTS = 14
    FLOATING_CHANGED = 15
    NOT_SOLVED = 16
    DIVERGED = 17
    STEP_TOO_SHORT = 18
    NEARLY_SINGULAR = 19
    MISLED = 20
    """FMUs' dependencies are not true, and there is no order that does without them yet."""
    ENDLESS_STEPS = 21
    ENDLESS_TICKS = 22
    BAD_INTERVAL = 23
    BETWEEN_POINTS = 24
    NO_FUNCTION = 31
    CHATTERS = 32
    TOO_INACCURATE = 33
    TOO_MANY_STEPS = 34
    EVENTS_UNSETTLED = 35
    SLOPE_NOT_FINITE = 36
    INDICATOR_NOT_FINITE = 37
    STATE_NOT_FINITE = 38
    COUNT_DIFFERS = 39
    SINGULAR = 40
    EVENT_NEVER = 41

    @property
    def is_of_integration(self) -> bool:
        """Whether it is about the solver of a model exchange FMU."""
        return self >= StopReason.CHATTERS
