"""When a process is worn out: how many instances it bears of FMUs that were seen not to bear any number of them."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from dse.domain.facts import FmuFacts, Question
from dse.domain.system import SystemStructure
from dse.errors import Problem, raise_if_any

_SAFETY = 2
"""An FMU that survived n instances is trusted with n / _SAFETY of them: other runs may wear it out faster."""


def most_runs(system: SystemStructure, facts: Mapping[str, FmuFacts]) -> int | None:
    """How many runs on fresh instances one process may make, at least one; None for any number."""
    most = _runs(system, {path: limit for path, (limit, _) in _limits(system, facts).items()})
    return None if most is None else max(1, most)


class InstanceBudget:
    """Counts the instances made in this process of FMUs that bear only so many of them."""

    def __init__(self, system: SystemStructure, facts: Mapping[str, FmuFacts]) -> None:
        self._system = system
        self._limits = _limits(system, facts)
        self._single = {
            element.model.library: element.name
            for element in system.elements
            if element.name in facts and facts[element.name].denies(Question.RENEWS)
        }

    def note(self) -> None:
        """One more instance of every element is made; DseError if it is known that it would not be like the first."""
        with _lock:
            raise_if_any(
                Problem(
                    f"{name}: a second instance in one process is known to differ from the first",
                    hint="simulate it again in a fresh process",
                )
                for path, name in self._single.items()
                if _made[path]
            )
            _made.update({path: n for path, (_, n) in self._limits.items()})

    @property
    def runs_left(self) -> int | None:
        """How many more times instances may be made, at least once in a process; None for any number."""
        if not self._limits:
            return None
        with _lock:
            left = _runs(self._system, {path: limit - _made[path] for path, (limit, _) in self._limits.items()})
            return left or int(not any(_made[path] for path in self._limits))


_made: Counter[Path] = Counter()
_lock = threading.Lock()


def _limits(system: SystemStructure, facts: Mapping[str, FmuFacts]) -> dict[Path, tuple[int, int]]:
    """How many instances of each library a process bears, and how many of them *system* has."""
    limits: dict[Path, tuple[int, int]] = {}
    for element in system.elements:
        known, path = facts.get(element.name), element.model.library
        most = None if known is None else _most_instances(known)
        if most is not None:
            limits[path] = most, limits.get(path, (most, 0))[1] + 1
    return limits


def _most_instances(known: FmuFacts) -> int | None:
    if known.denies(Question.RENEWS):
        return 1
    return None if known.most_instances is None else max(1, known.most_instances // _SAFETY)


def _runs(system: SystemStructure, left: Mapping[Path, int]) -> int | None:
    used = Counter(element.model.library for element in system.elements)
    return min((max(0, n) // used[path] for path, n in left.items()), default=None)
