"""What is computed of the same runs again and again, computed once for as long as they are looked at."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

from dse.analysis.data import StudyData

P = ParamSpec("P")
T = TypeVar("T")


def once(function: Callable[Concatenate[StudyData, P], T]) -> Callable[Concatenate[StudyData, P], T]:
    """*function* of data and names, whose values are kept with the data; not what it raises."""

    @wraps(function)
    def kept(data: StudyData, /, *arguments: P.args, **named: P.kwargs) -> T:
        key: Hashable = (function.__qualname__, arguments, *named.items())
        if key not in data.known:
            data.known[key] = function(data, *arguments, **named)
        found: T = data.known[key]
        return found

    return kept
