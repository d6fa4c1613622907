"""What is computed of the same runs again and again, computed once for as long as they are looked at."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

from dse.analysis.data import StudyData
from dse.errors import DseError

P = ParamSpec("P")
T = TypeVar("T")


def memoized(function: Callable[Concatenate[StudyData, P], T]) -> Callable[Concatenate[StudyData, P], T]:
    """*function* of data and names, whose values, and reasons for none, are kept with the data."""

    @wraps(function)
    def kept(data: StudyData, /, *arguments: P.args, **named: P.kwargs) -> T:
        key: Hashable = (function.__qualname__, arguments, *named.items())
        if key not in data.known:
            try:
                data.known[key] = function(data, *arguments, **named)
            except DseError as reason:
                data.known[key] = reason
        found: T | DseError = data.known[key]
        if isinstance(found, DseError):
            raise found
        return found

    return kept
