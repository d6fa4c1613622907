"""Measured or prescribed values over time, as columns of files."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from dse.domain.component import Source
from dse.errors import Location


class Interpolation(StrEnum):
    """What holds between two samples."""

    LINEAR = "linear"
    PREVIOUS = "previous"


class Outside(StrEnum):
    """What holds before the first and after the last sample."""

    HOLD = "hold"
    PERIODIC = "periodic"
    ERROR = "error"


class Missing(StrEnum):
    """What is done about a sample without a value."""

    ERROR = "error"
    SKIP = "skip"


@dataclass(frozen=True, slots=True)
class TableFile:
    """A file with columns, and what is said of how it is written; "" for what is to be found out."""

    path: Path
    separator: str = ""
    decimal: str = ""
    skip_lines: int = 0
    group: int | None = None


@dataclass(frozen=True, slots=True)
class Series:
    """What the output *port* gives over time: a *column* of *file*, by heading or by its number from 1.

    *time* is the column of times, "" for the usual one; a unit after a heading is in brackets. *interpolation* None is
    the usual one of the port's type. *where* is the column's place in a file of the user.
    """

    port: str
    file: TableFile
    column: str | int
    time: str | int
    interpolation: Interpolation | None
    outside: Outside
    missing: Missing
    where: Location


@dataclass(frozen=True, slots=True)
class TimeSeriesSource(Source):
    """A component that gives values of files over time.

    *stop* is how long it is simulated, in seconds; None where nobody knows.
    """

    kind = "time_series"
    label = "time series"

    series: tuple[Series, ...]
    stop: float | None = None

    @property
    def is_exact(self) -> bool:
        """Tables integrate nothing."""
        return True
