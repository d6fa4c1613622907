"""Choosing like at a car dealer's: after each choice, what can still be had, why the rest cannot, and what it costs.

One pass over the diagram of the valid rows answers for every choice at once: each is a scenario of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from dse.domain.design import Constraint, DesignSpace
from dse.errors import fail
from dse.space.configurations.ids import identify
from dse.space.decisions import Choices, sites
from dse.space.flat import Bools, by_path
from dse.space.methods.engine import Engine
from dse.space.methods.mdd.diagram import DecisionDiagram, count, extremes, restrict
from dse.space.methods.mdd.scenarios import ScenarioBits, Scenarios, bits_of, possible, taken, whole
from dse.space.output.sums import PropertySum, property_sums
from dse.space.questions.conflict import minimal_conflict
from dse.space.questions.offer import Addition, ChoicePoint, Offer, OfferedChoice, OfferedTotal, titled
from dse.space.restriction.choices import ABSENT_NAME, read_choices

_ALSO = ("cost", "mass")
"""Properties whose sum makes sense in any design, whatever its constraints speak of."""

_NOW = 0
"""The scenario in which nothing is chosen but what is chosen."""

PlaceChoice = tuple[str, str]
"""A place and what is chosen there."""

Masks = Mapping[int, Bools]
"""What variables may take, by their numbers; each of shape (values + 1,)."""


class Dealership:
    """Offers of the valid configurations of *space*. Raises DseError if they are too many for a decision diagram."""

    def __init__(self, space: DesignSpace, engine: Engine) -> None:
        if engine.expanded is None:
            hint = f"choose step by step: dse enumerate {space.name} --interactive"
            raise fail(f"'{space.name}' is too large to compute at once what can be chosen", space.where, hint)
        self.space = space
        self._diagram: DecisionDiagram = engine.expanded
        self._variables = engine.flat.variables
        self._at = by_path(self._variables)
        self._titles = {(site.path, site.name): site.component.title for site in sites(space) if site.component}
        self._totals = tuple(total for total in property_sums(space, _ALSO) if total.is_small)
        self._total = count(self._diagram)
        self._reasons = Reasons(engine)
        self._alone: dict[int, list[int]] = {}
        self._of: dict[PlaceChoice, list[int]] = {}
        """The scenarios of each choice: one for each decision that can make it."""
        self._number = _NOW + 1
        for variable, each in enumerate(self._variables):
            for name in each.values:
                self._alone.setdefault(variable, []).append(self._number)
                self._of.setdefault((each.path, name or ABSENT_NAME), []).append(self._number)
                self._number += 1
        self._without = {path: self._number + place for place, path in enumerate(self._at)}
        """The scenarios in which a place is not there."""
        self._number += len(self._without)
        self._groups = {choice: sum(1 << each for each in found) for choice, found in self._of.items()}

    def offer(self, chosen: Choices) -> Offer:
        """What is left under what is *chosen* by path, ``absent`` for left out. Raises DseError for unknown choices."""
        chosen = read_choices(self.space, [f"{path}={name}" for path, name in chosen.items()])
        masks = {path: self._masks(path, name) for path, name in chosen.items()}
        left = restrict(self._diagram, _joined(masks.values()))
        number = count(left)
        scenarios = self._scenarios(masks)
        choices = self._single(left) if number == 1 else {}
        return Offer(
            self.space.name,
            self.space.title or self.space.name,
            chosen,
            self._total,
            number,
            tuple(self._points(chosen, scenarios, masks)),
            tuple(_range(left, total) for total in self._totals) if number else (),
            identify(choices) if number == 1 else "",
            choices,
            () if number else self._because(scenarios, [1 << _NOW])[0],
        )

    def _points(self, chosen: Choices, scenarios: Scenarios, masks: Mapping[str, Masks]) -> Iterator[ChoicePoint]:
        found = taken(self._diagram, scenarios)
        possible = whole(np.bitwise_or.reduce(found[0], axis=0)) if found else 0
        # In which scenarios each choice is made in some configuration.
        made = dict.fromkeys(self._of, 0)
        for each, rows in zip(self._variables, found, strict=True):
            for name, words in zip(each.values, rows, strict=False):
                made[each.path, name or ABSENT_NAME] |= whole(words)
        open_ = [choice for choice, bits in made.items() if bits >> _NOW & 1 and choice[0] not in chosen]
        # Where nothing is left, what can be chosen instead of something else is shown.
        ways = open_ if possible >> _NOW & 1 else [each for each, group in self._groups.items() if possible & group]
        seen = {*chosen, *(path for path, _ in ways)}
        shown = [choice for choice in self._of if choice[0] in seen]
        cannot = [choice for choice in shown if not possible & self._groups[choice]]
        changes = self._changes(cannot, masks)
        why = dict(zip(cannot, self._because(scenarios, [self._groups[choice] for choice in cannot]), strict=True))
        for path in dict.fromkeys(path for path, _ in shown):
            can = [name for place, name in open_ if place == path]
            is_certain = not possible >> self._without[path] & 1
            implied = can[0] if len(can) == 1 and is_certain else ""

            def offered(choice: PlaceChoice, told: tuple[str, ...] = (chosen.get(path, ""), implied)) -> OfferedChoice:
                group, is_news = self._groups[choice], choice not in why and choice[1] not in told
                gone = [each for each in open_ if is_news and each[0] != choice[0] and not made[each] & group]
                title = titled(choice[1], self._titles.get(choice, ""))
                change, adds = changes.get(choice, ()), self._adds(choice)
                return OfferedChoice(
                    choice[1], title, choice not in why, why.get(choice, ()), tuple(gone), change, adds
                )

            offers = tuple(offered(choice) for choice in shown if choice[0] == path)
            yield ChoicePoint(path, titled(path), chosen.get(path, ""), implied, is_certain, offers)

    def _changes(self, cannot: Sequence[PlaceChoice], masks: Mapping[str, Masks]) -> dict[PlaceChoice, tuple[str, ...]]:
        """Of what cannot be chosen, the places of which each alone, if nothing were chosen there, would allow it."""
        found: dict[PlaceChoice, tuple[str, ...]] = {}
        for path in masks if cannot else ():
            others = {each: mask for each, mask in masks.items() if each != path}
            left = whole(possible(self._diagram, self._scenarios(others)))
            for choice in cannot:
                if choice[0] != path and left & self._groups[choice]:
                    found[choice] = (*found.get(choice, ()), path)
        return found

    def _adds(self, choice: PlaceChoice) -> tuple[Addition, ...]:
        """What a choice adds by itself to the sums that any design may have."""
        path, name = choice
        number = next(n for n in self._at[path] if (name if name != ABSENT_NAME else None) in self._variables[n].values)
        place = self._variables[number].values.index(None if name == ABSENT_NAME else name)
        return tuple(
            Addition(total.name, str(total.unit), float(int(weights[place]) * total.scale / total.unit.factor))
            for total in self._totals
            if total.name in _ALSO and (weights := total.weights.get(number)) is not None
        )

    def _scenarios(self, masks: Mapping[str, Masks]) -> Scenarios:
        """Each choice with all that is chosen elsewhere, as *masks* by path; not with what is chosen inside it."""
        everywhere = bits_of(range(self._number), self._number)
        allowed: dict[int, ScenarioBits] = {}
        for variable, alone in self._alone.items():
            others = everywhere & ~bits_of([*alone, self._without[self._variables[variable].path]], self._number)
            rows = [others | bits_of([each], self._number) for each in alone]
            allowed[variable] = np.array([*rows, everywhere & ~bits_of(alone, self._number)])
        for path, each in masks.items():
            free = [s for choice, found in self._of.items() if f"{path}.".startswith(f"{choice[0]}.") for s in found]
            bound = everywhere & ~bits_of(free, self._number)
            for variable, mask in each.items():
                allowed[variable][~mask] &= ~bound
        return Scenarios(self._number, allowed)

    def _masks(self, path: str, name: str) -> Masks:
        """What variables may take so that *name* is chosen at *path*. Raises DseError if that cannot be said so."""
        at = self._at[path]
        values = {number: self._variables[number].values for number in at}
        if name == ABSENT_NAME:
            return {number: np.array([*(value is None for value in known), True]) for number, known in values.items()}
        if len(at) == 1:
            return {number: np.array([*(value == name for value in known), False]) for number, known in values.items()}
        # One of these decisions at most exists, and with the right choice above one does.
        parents = {parent for number in at if (parent := self._variables[number].parent) and name in values[number]}
        above = {number for number, _ in parents}
        if len(above) > 1:
            what = f"'{path}' is in architectures at different places"
            raise fail(what, self.space.where, f"choose first: {', '.join(self._variables[n].path for n in above)}")
        masks = {number: np.array([*(value == name for value in known), True]) for number, known in values.items()}
        for number in above:
            length = len(self._variables[number].values) + 1
            masks[number] = np.array([(number, value) in parents for value in range(length)])
        return masks

    def _because(self, scenarios: Scenarios, groups: Iterable[int]) -> list[tuple[Constraint, ...]]:
        constraints = self._diagram.flat.constraints
        return [tuple(constraints[each] for each in owners) for owners in self._reasons.of(scenarios, groups)]

    def _single(self, diagram: DecisionDiagram) -> Choices:
        """The choices of the only row of *diagram*."""
        row = np.zeros(len(self._variables), np.int16)
        for variable, layer in zip(diagram.order, diagram.layers, strict=True):
            value = int(np.argmax(layer[0] >= 0))
            row[variable] = value if value < len(self._variables[variable].values) else -1
        return diagram.flat.choices(row)


def _joined(masks: Iterable[Masks]) -> Masks:
    joined: dict[int, Bools] = {}
    for each in masks:
        for variable, mask in each.items():
            joined[variable] = joined[variable] & mask if variable in joined else mask
    return joined


def _range(diagram: DecisionDiagram, total: PropertySum) -> OfferedTotal:
    least, greatest = extremes(diagram, total.weights)
    low, high = (total.shown(total.start + int(ends[0][0])) for ends in (least, greatest))
    return OfferedTotal(total.name, titled(total.name), str(total.unit), low, high)


Excludes = Callable[[Sequence[int]], bool]
"""Whether constraints, by number, leave nothing."""


class Reasons:
    """Smallest sets of an engine's constraints that exclude something.

    A set that explained one thing often explains the next: those that were found are tried first, so which of several
    is told may depend on what was asked before; each is minimal.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._diagrams: dict[frozenset[int], DecisionDiagram | None] = {}
        self._conflicts: list[tuple[int, ...]] = [(number,) for number in range(len(engine.flat.constraints))]

    def of(self, scenarios: Scenarios, groups: Iterable[int]) -> list[tuple[int, ...]]:
        """For each group, the bits of *scenarios* in none of which a row is valid: the constraints that say so.

        Their numbers, ascending; () if nothing is left whatever the constraints.
        """
        left: dict[frozenset[int], int] = {}

        def excludes(group: int, owners: Sequence[int]) -> bool:
            key = frozenset(owners)
            if key not in left:
                diagram = self._diagram(key)
                # Where it cannot be told, a constraint too much may be named, and never one too few.
                left[key] = -1 if diagram is None else whole(possible(diagram, scenarios))
            return not left[key] & group

        return [self._conflict(partial(excludes, group)) for group in groups]

    def _conflict(self, excludes: Excludes) -> tuple[int, ...]:
        if excludes(()):
            return ()
        for known in self._conflicts:
            if excludes(known) and not any(excludes(_without(known, each)) for each in known):
                return known
        every = range(len(self._engine.flat.constraints))
        found = minimal_conflict(every, lambda owners: not excludes(owners))
        self._conflicts = sorted([*self._conflicts, found], key=len)
        return found

    def _diagram(self, owners: frozenset[int]) -> DecisionDiagram | None:
        if owners not in self._diagrams:
            self._diagrams[owners] = self._engine.only(sorted(owners)).expanded
        return self._diagrams[owners]


def _without(numbers: Sequence[int], number: int) -> tuple[int, ...]:
    return tuple(each for each in numbers if each != number)
