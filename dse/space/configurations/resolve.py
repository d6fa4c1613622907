"""Choices → configuration."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import groupby
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Component
from dse.domain.design import Compound, Configuration, Connection, DesignSpace, walk
from dse.errors import Problem, raise_if_any
from dse.space.configurations.ids import Identifier
from dse.space.configurations.lookup import Lookup, LookupColumn
from dse.space.configurations.wiring import wire
from dse.space.decisions import Choices, Site, decisions, made, sites
from dse.space.flat import FlatSpace, Rows, Variable
from dse.space.lowering.shape import shape_of

_T = TypeVar("_T")
ResolvedEntry = tuple[str | None, _T | None]
"""A path and what stands there; (None, None) for nothing."""

_NOTHING: tuple[None, None] = (None, None)
_MOST_WIRINGS = 4096
_AT_A_TIME = 1024


def resolve(space: DesignSpace, choices: Choices) -> Configuration:
    """The configuration that *choices* describe, whether it is valid or not.

    Raises DseError if a decision is missing, does not exist, or has no such option.
    """
    problems: list[Problem] = []
    left = dict(choices)
    for decision, branch in made(decisions(space), choices.get):
        choice = left.pop(decision.path, None)
        if branch is None:
            options = ", ".join(b.choice or "(left out)" for b in decision.branches)
            what = f"'{decision.path}' cannot be '{choice}'" if choice else f"nothing is chosen for '{decision.path}'"
            problems.append(Problem(what, None, f"possible: {options}"))
    problems += [Problem(f"there is no decision '{path}' in this design", space.where, "remove it") for path in left]
    raise_if_any(problems)
    return Resolver(space).configuration(choices)


class Resolver:
    """Makes configurations of one space; wiring is computed once for all that are built alike."""

    def __init__(self, space: DesignSpace) -> None:
        self._space = space
        self._plain = FlatSpace(space.name, shape_of(space).variables, (), ())
        variables, there = self._plain.variables, sites(space)
        self._identifier = Identifier(variables)
        self._choices = Lookup([_choice_column(number, variable) for number, variable in enumerate(variables)])
        self._parts = Lookup(part_columns(variables, there))
        wired = [
            (path, one) for path, node in walk(space.root) if isinstance(node, Compound) for one in node.connections
        ]
        self._is_wired = bool(wired)
        conditions = {f"{path}.{one.when[0]}" if path else one.when[0] for path, one in wired if one.when}
        self._classes = _classes(variables, there, conditions)
        self._wirings: dict[bytes, tuple[Connection, ...]] = {}

    def configuration(self, choices: Choices) -> Configuration:
        """The configuration of *choices*, which must be complete and fit the space."""
        return next(self.configurations(self._plain.row(choices)[None, :]))

    def configurations(self, rows: Rows) -> Iterator[Configuration]:
        """The configurations of a block of rows, shape (rows, variables); they need not be valid.

        Raises DseError if connections cannot be resolved.
        """
        for start in range(0, len(rows), _AT_A_TIME):
            block = rows[start : start + _AT_A_TIME]
            ids, built = self._identifier.ids(block), self._built(block)
            for name, chosen, standing, key in zip(
                ids, self._choices.of(block), self._parts.of(block), built, strict=True
            ):
                choices: dict[str, str] = _mapping(chosen)
                parts: dict[str, Component] = _mapping(standing)
                yield Configuration(name, choices, parts, self._wiring(key, choices) if self._is_wired else ())

    def _wiring(self, built: bytes, choices: Choices) -> tuple[Connection, ...]:
        if built not in self._wirings:
            if len(self._wirings) >= _MOST_WIRINGS:
                self._wirings.clear()
            self._wirings[built] = wire(self._space, choices)
        return self._wirings[built]

    def _built(self, rows: Rows) -> list[bytes]:
        """What of each row decides its wiring."""
        taken = np.zeros((len(rows), len(self._classes)), np.int16)
        for column, (variable, classes) in enumerate(self._classes):
            taken[:, column] = classes[rows[:, variable]]
        return [row.tobytes() for row in taken]


def _mapping(entries: Sequence[ResolvedEntry[_T]]) -> dict[str, _T]:
    found = dict(entries)
    found.pop(None, None)
    return found  # type: ignore[return-value]  # only (None, None) has a None


def _choice_column(number: int, variable: Variable) -> LookupColumn[ResolvedEntry[str]]:
    entries = [_NOTHING if name is None else (variable.path, name) for name in variable.values]
    return number, [*entries, _NOTHING]


def part_columns(variables: Sequence[Variable], there: Sequence[Site]) -> list[LookupColumn[ResolvedEntry[Component]]]:
    """A column for each run of components that stand at one path by one decision, in the order of the file."""
    columns: list[LookupColumn[ResolvedEntry[Component]]] = []
    components = [site for site in there if site.component]
    for (path, variable), run in groupby(components, lambda site: (site.path, site.branch and site.branch[0])):
        if variable is None:
            columns += [(None, [(path, site.component)]) for site in run]
            continue
        entries: list[ResolvedEntry[Component]] = [_NOTHING] * (len(variables[variable].values) + 1)
        for site in run:
            assert site.branch  # noqa: S101  # the run's decision puts it there
            entries[site.branch[1]] = (path, site.component)
        columns.append((variable, entries))
    return columns


def _classes(
    variables: Sequence[Variable], there: Sequence[Site], conditions: Collection[str]
) -> list[tuple[int, NDArray[np.int16]]]:
    """The decisions that matter to the wiring, with a number for each value that is the same for values wired alike.

    What is chosen at the places *conditions* matters by itself.
    """
    shapes: list[list[tuple[tuple[str, str], ...]]] = [
        [((variable.path, name or ""),) if variable.path in conditions else () for name in (*variable.values, None)]
        for variable in variables
    ]
    for site in there:
        if site.branch:
            variable, value = site.branch
            shapes[variable][value] += (_shape(site),)
    found = []
    for number, values in enumerate(shapes):
        known = {shape: place for place, shape in enumerate(dict.fromkeys(values))}
        if len(known) > 1:
            found.append((number, np.array([known[shape] for shape in values], np.int16)))
    return found


def _shape(site: Site) -> tuple[str, str]:
    """What of a site decides the wiring: a component's interface, an architecture's name."""
    return site.path, f":{site.component.interface.name}" if site.component else site.name
