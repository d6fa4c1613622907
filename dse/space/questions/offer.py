"""What can still be chosen: the nouns of a dealership."""

from __future__ import annotations

from dataclasses import dataclass, field

from dse.domain.design import Constraint
from dse.space.decisions import Choices
from dse.space.restriction.choices import ABSENT_NAME

NO_PLACE = "the other choices leave no place for it"
"""Why something cannot be chosen that no constraint forbids."""


@dataclass(frozen=True, slots=True)
class Addition:
    """What a choice adds to the sum *name*: *value* in *unit*."""

    name: str
    unit: str
    value: float


@dataclass(frozen=True, slots=True)
class OfferedChoice:
    """One thing that can be chosen at a place, ``absent`` for leaving it out.

    It is possible if a valid configuration has it and all that is chosen elsewhere; what is chosen inside the place
    itself would go with it. If it is not, *because* are constraints that nothing meets together, all but any one of
    them can be met; none if the choices exclude each other whatever the constraints. *rules_out* are the choices,
    (path, name), at places that are not chosen yet which are possible now and would not be any more. *change* are the
    places whose choice, given up alone, would make it possible. *adds* is what it adds itself to sums such as the cost.
    """

    name: str
    title: str
    is_possible: bool
    because: tuple[Constraint, ...] = ()
    rules_out: tuple[tuple[str, str], ...] = ()
    change: tuple[str, ...] = ()
    adds: tuple[Addition, ...] = ()

    def texts(self) -> tuple[str, ...]:
        """Why it is not possible, for a person; () if it is."""
        return () if self.is_possible else reasons(self.because)


@dataclass(frozen=True, slots=True)
class ChoicePoint:
    """A place where something can be chosen. *chosen* is what the user has, *implied* what follows from that by itself.

    Each is "" if there is none. With *is_certain* every configuration that is left has the place, else some do.
    """

    path: str
    title: str
    chosen: str
    implied: str
    is_certain: bool
    choices: tuple[OfferedChoice, ...]


@dataclass(frozen=True, slots=True)
class OfferedTotal:
    """The sum of a property over what is left: between *low* and *high*, both of which are reached, in *unit*."""

    name: str
    title: str
    unit: str
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Offer:
    """What is left of a design space under what is *chosen*: *left* of *total* valid configurations.

    If it is one, *configuration* is its id and *choices* are all its choices. If it is none, *conflict* are
    constraints that stand in the way, as in `OfferedChoice`; what is possible then is a way out.
    """

    design: str
    title: str
    chosen: Choices
    total: int
    left: int
    points: tuple[ChoicePoint, ...]
    totals: tuple[OfferedTotal, ...] = ()
    configuration: str = ""
    choices: Choices = field(default_factory=dict)
    conflict: tuple[Constraint, ...] = ()

    def point(self, path: str) -> ChoicePoint:
        """The place called *path*; KeyError if none of what is left has it."""
        for point in self.points:
            if point.path == path:
                return point
        raise KeyError(path)

    def texts(self) -> tuple[str, ...]:
        """Why nothing is left, for a person; () if something is."""
        return () if self.left else reasons(self.conflict)

    def data(self) -> dict[str, object]:
        """The same for a program. Counts are texts: they may have more digits than a number in JavaScript."""
        return {
            "design": self.design,
            "title": self.title,
            "chosen": dict(self.chosen),
            "total": str(self.total),
            "left": str(self.left),
            "configuration": self.configuration or None,
            "choices": dict(self.choices),
            "conflict": list(self.texts()),
            "points": [_point(point) for point in self.points],
            "totals": [
                {"name": each.name, "title": each.title, "unit": each.unit, "low": each.low, "high": each.high}
                for each in self.totals
            ],
        }


def reasons(constraints: tuple[Constraint, ...]) -> tuple[str, ...]:
    """Why something cannot be, for a person: what the constraints say of themselves, else what they are called."""
    return tuple(each.because or each.name for each in constraints) or (NO_PLACE,)


def titled(name: str, title: str = "") -> str:
    """What a person reads for *name*: its *title*, else its words."""
    return title or ("left out" if name == ABSENT_NAME else name.replace("_", " ").replace(".", " "))


def _point(point: ChoicePoint) -> dict[str, object]:
    return {
        "path": point.path,
        "title": point.title,
        "chosen": point.chosen or None,
        "implied": point.implied or None,
        "is_certain": point.is_certain,
        "alternatives": [
            {
                "name": each.name,
                "title": each.title,
                "is_possible": each.is_possible,
                "because": list(each.texts()),
                "constraints": [constraint.name for constraint in each.because],
                "rules_out": [{"path": path, "name": name} for path, name in each.rules_out],
                "change": list(each.change),
                "adds": [{"name": one.name, "unit": one.unit, "value": one.value} for one in each.adds],
            }
            for each in point.choices
        ],
    }
