"""What the master does with what is known of FMUs: what it refuses, never tries, and when a process is worn out.

An FMU nothing is known of is taken by its word, but its reset is put to the proof (`Simulator`).
"""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType

from dse.domain.facts import FmuFacts, Question
from dse.domain.method import Coupling, Method
from dse.domain.system import Element, SystemStructure
from dse.errors import Problem, raise_if_any

Facts = Mapping[str, FmuFacts]
"""What is known of elements, by their names."""

NOTHING_KNOWN: Facts = MappingProxyType({})

_SAFETY = 2
"""An FMU that survived n instances is trusted with n / _SAFETY of them: other runs may wear it out faster."""


def refusals(system: SystemStructure, method: Method, facts: Facts) -> Iterable[Problem]:
    """Why *system* must not be simulated by *method*, as its FMUs were seen not to bear it."""
    counted: dict[Path, list[str]] = {}
    for element in system.elements:
        counted.setdefault(element.model.library, []).append(element.name)
    for names in counted.values():
        known = facts.get(names[0])
        if len(names) > 1 and known is not None and (known.denies(Question.COEXISTS) or known.denies(Question.RENEWS)):
            question = Question.COEXISTS if known.denies(Question.COEXISTS) else Question.RENEWS
            yield Problem(
                f"{', '.join(names)}: {known.identifier} does not bear several instances in one process: "
                f"{known.reasons.get(question, 'they disturb each other')}",
                hint="use it in one element only",
            )
    if method.adaptive is not None:
        for name, known in facts.items():
            if known.denies(Question.SAVES):
                yield Problem(
                    f"{name}: an adaptive step needs saved states, and those of {known.identifier} do not work: "
                    f"{known.reasons.get(Question.SAVES, 'outputs differ afterwards')}",
                    hint="simulate it with a fixed step",
                )
            if known.denies(Question.VARIES_STEP):
                yield Problem(
                    f"{name}: an adaptive step varies, and {known.identifier} was seen not to bear that: "
                    f"{known.reasons.get(Question.VARIES_STEP, 'steps of uneven length fail')}",
                    hint="simulate it with a fixed step",
                )
    if method.coupling is not Coupling.NONE:
        for element in system.elements:
            known = facts.get(element.name)
            if known is not None and known.denies(Question.FEEDS_THROUGH) and _has_to_follow(element):
                yield Problem(
                    f"{element.name}: coupling: {method.coupling.value} needs outputs that follow inputs between two "
                    f"steps, and those of {known.identifier} were seen not to, although it declares so",
                    hint="use coupling: none",
                )


def _has_to_follow(element: Element) -> bool:
    """Whether outputs depend directly on connected inputs, as the FMU tells."""
    inputs = {variable.name for variable in element.inputs}
    return any(inputs & set(element.model.depends.get(variable.name, ())) for variable in element.outputs)


def never_reset(facts: Facts) -> tuple[str, ...]:
    """Elements whose reset is known not to lead to what a fresh instance is."""
    return tuple(name for name, known in facts.items() if known.denies(Question.RESETS))


def most_runs(system: SystemStructure, facts: Facts) -> int | None:
    """How many runs on fresh instances one process may make, at least one; None for any number."""
    most = _runs(system, {path: limit for path, (limit, _) in _limits(system, facts).items()})
    return None if most is None else max(1, most)


class Wear:
    """Counts the instances made in this process of FMUs that bear only so many of them."""

    def __init__(self, system: SystemStructure, facts: Facts) -> None:
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


def _limits(system: SystemStructure, facts: Facts) -> dict[Path, tuple[int, int]]:
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
