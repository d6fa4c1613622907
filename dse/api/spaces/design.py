"""A design space and the questions to it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Required, TypedDict, overload

from dse.api.authoring.defined import Defined, FileKind, InWorkspace
from dse.api.lookup import aims_of, condition_of, space_of
from dse.api.presentation.html import table
from dse.domain.design import DesignSpace

if TYPE_CHECKING:
    from typing import Unpack

    import pandas as pd

    from dse.domain.design import Configuration, Constraint
    from dse.space import Aim, Difference, Explanation, Impact, Occurrence, OpenedSpace, Ranked, Tally
    from dse.units import Unit


class Narrowing(TypedDict, total=False):
    """What every question takes: *choose* says what is chosen where (``absent``: left out), *where* is a condition.

    *on* and *off* name constraint sets to switch.
    """

    choose: Mapping[str, str]
    where: str
    on: Sequence[str]
    off: Sequence[str]


class DesignKeys(TypedDict, total=False):
    """The arguments of `Design`: the keys of a file in ``designs/``."""

    title: str
    units: Mapping[str, Any]
    root: Required[Mapping[str, Any]]
    constraints: Mapping[str, Any]
    constraint_sets: Mapping[str, Any]


_FILE: FileKind[DesignSpace] = FileKind(
    "Design", "design", "designs", ".yaml", lambda files, name: space_of(name, workspace=files)
)


class Design(Defined[DesignSpace]):
    """A design space; *space* is its data. What a question compiles is kept for the next one.

    Iterating gives every valid configuration, one at a time, in the order of the file. All questions take *choose*,
    *where*, *on* and *off*, and raise DseError if these name something unknown.

    >>> design = dse.open(".").designs["acc_vehicle"]
    >>> design.count(choose={"sensor": "radar_77ghz_mid"}, where="sum(cost) <= 6000 EUR")
    33
    >>> design.explain(choose={"sensor": "camera_mono", "powertrain": "bev_ideal"}).is_valid
    True
    """

    def __init__(self, design: str, *, workspace: InWorkspace | None = None, **keys: Unpack[DesignKeys]) -> None:
        """Define the design space called *design*; the other arguments are the keys of its file.

        In ``root={"compound": {"sensor": {"alternatives": [radar, "lidar_905nm"]}}}``, components are named or given.
        The file is written to *workspace*, by default that of the components. Raises DseError, which names the
        argument.
        """
        super().__init__(*_FILE.define(design, keys, workspace))

    @cached_property
    def _opened(self) -> dict[tuple[tuple[str, ...], tuple[str, ...]], OpenedSpace]:
        return {}

    @property
    def space(self) -> DesignSpace:
        """Its data."""
        return self.noun

    def to_yaml(self, target: str | Path | None = None) -> str:
        """As YAML, also of a design that was refined or read from UVL; written to the file *target* if that is given.

        Raises DseError if *target* cannot be written.
        """
        if self.definitions is not None:
            return super().to_yaml(target)
        from dse.loading import write_design
        from dse.scratch import write_whole

        text = write_design(self.space)
        if target is not None:
            write_whole(Path(target), text)
        return text

    @property
    def total(self) -> int:
        """The number of combinations without constraints."""
        from dse.space import combinations

        return combinations(self.space)

    @overload
    def count(self, *, exact: Literal[True], seed: int = 0, **narrowing: Unpack[Narrowing]) -> int: ...
    @overload
    def count(self, *, exact: bool = False, seed: int = 0, **narrowing: Unpack[Narrowing]) -> int | Tally: ...
    def count(self, *, exact: bool = False, seed: int = 0, **narrowing: Unpack[Narrowing]) -> int | Tally:
        """How many configurations are valid; an estimate (`Tally`) if counting takes long, unless *exact*."""
        tally = self._part(**narrowing).count(seed, exact=exact)
        return tally.value if tally.exact else tally

    def list(self, limit: int | None = None, **narrowing: Unpack[Narrowing]) -> Sequence[Configuration]:
        """The valid configurations, in the order of the file; the first *limit* of them."""
        return [*self._part(**narrowing).configurations(limit)]

    def sample(self, number: int, seed: int = 0, **narrowing: Unpack[Narrowing]) -> Sequence[Configuration]:
        """*number* configurations drawn at random, independently, all valid ones equally likely."""
        part = self._part(**narrowing)
        return [*part.resolved([part.draw(number, seed)])]

    def configuration(self, name: str) -> Configuration:
        """The valid configuration whose id is *name* or starts with it."""
        return self._part().configuration(name)

    def best(
        self, minimize: str | None = None, *, maximize: str | None = None, n: int = 10, **narrowing: Unpack[Narrowing]
    ) -> Ranking:
        """The *n* best valid configurations under one objective, as ``sum(cost)``. Exact: no other one is better."""
        from dse.errors import fail

        wanted = aims_of([minimize] if minimize else [], [maximize] if maximize else [], self.space)
        if len(wanted) != 1:
            raise fail("one objective is needed", None, "give minimize or maximize; for several ask for 'pareto'")
        part = self._part(**narrowing)
        return Ranking(part, wanted, part.best(wanted[0], n))

    def pareto(
        self, minimize: str | Sequence[str] = (), maximize: str | Sequence[str] = (), **narrowing: Unpack[Narrowing]
    ) -> Ranking:
        """The complete Pareto set: configurations that no other one beats, one for each point."""
        from dse.errors import fail

        wanted = aims_of(several(minimize), several(maximize), self.space)
        if len(wanted) < 2:
            raise fail("two objectives or more are needed", None, "for one ask for 'best'")
        part = self._part(**narrowing)
        return Ranking(part, wanted, part.pareto(wanted))

    def explain(
        self, choose: Mapping[str, str], *, where: str | None = None, on: Sequence[str] = (), off: Sequence[str] = ()
    ) -> Explanation:
        """Why the configuration with these choices is excluded, and which valid one is nearest.

        If only some choices are given: whether they can be completed, and if not, which constraints prevent it.
        """
        return self._opening(on, off).part((), condition_of(where, self.space)).explain(_texts(choose))

    def conflict(self, **narrowing: Unpack[Narrowing]) -> tuple[Constraint, ...]:
        """Why no configuration is valid: a smallest set of constraints that cannot be met together.

        Empty if there are valid configurations, or if the choices exclude each other whatever the constraints.
        """
        part = self._part(**narrowing)
        return part.conflict() if part.is_empty() else ()

    def constraints(self, *names: str, seed: int = 0, **narrowing: Unpack[Narrowing]) -> tuple[Impact, ...]:
        """The effect of each constraint, or of *names*: the configurations it excludes; whether it is redundant."""
        return self._part(**narrowing).impact(names, seed)

    def choices(self, *, seed: int = 0, **narrowing: Unpack[Narrowing]) -> tuple[Occurrence, ...]:
        """How often each alternative occurs among the valid configurations; which are dead, and which forced."""
        return self._part(**narrowing).occurrences(seed)

    def compare(self, other: Design, *, seed: int = 0) -> Difference:
        """What was added and removed from here to *other*, and how many configurations both have."""
        return self._opening().difference(other._opening(), seed)

    def refine(self, keep: Mapping[str, Iterable[str]]) -> Design:
        """The design with only these alternatives at these places (``absent``: left out); ids stay the same."""
        return Design.of(self._opening().refined(f"{path}={','.join(names)}" for path, names in keep.items()))

    def to_pandas(self, limit: int | None = None, **narrowing: Unpack[Narrowing]) -> pd.DataFrame:
        """A row for each valid configuration, the first *limit*: its choices and the sums that constraints use.

        ``frame.attrs["units"]`` has the units of the sums. What is left out is missing (None).
        """
        from dse.api.presentation.html import configurations_frame

        return configurations_frame(self._part(**narrowing), limit)

    def __iter__(self) -> Iterator[Configuration]:
        return self._opening().configurations()

    def __repr__(self) -> str:
        return f"<Design {self.name}: {self.total:,} combinations, {len(self.space.constraints)} constraints>"

    def _repr_html_(self) -> str:
        from dse.space import alternatives

        rows = [
            (path, ", ".join(choice or "absent" for choice in choices))
            for path, choices in alternatives(self.space).items()
        ]
        return table(f"{self.name}: {self.total:,} combinations", ("place", "alternatives"), rows)

    def opened(self) -> OpenedSpace:
        """Answers questions about the whole space."""
        return self._opening()

    def _part(self, **narrowing: Unpack[Narrowing]) -> OpenedSpace:
        whole = self._opening(narrowing.get("on", ()), narrowing.get("off", ()))
        return whole.part(_texts(narrowing.get("choose", {})), condition_of(narrowing.get("where"), self.space))

    def _opening(self, on: Sequence[str] = (), off: Sequence[str] = ()) -> OpenedSpace:
        from dse.space import open_space

        switches = tuple(on), tuple(off)
        if switches not in self._opened:
            self._opened[switches] = open_space(self.space, on=on, off=off)
        return self._opened[switches]


def _texts(choose: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(f"{path}={name}" for path, name in choose.items())


def several(texts: str | Sequence[str]) -> Sequence[str]:
    """*texts*, or the only one."""
    return (texts,) if isinstance(texts, str) else texts


# Configurations ranked by objectives.


class Ranking(Sequence["Ranked"]):
    """The best under *aims*, best first, or a Pareto set, ascending by the first aim.

    Each entry has ``id``, ``choices`` and ``values``, exact and in SI, one for each aim. *opened* is the design space.

    >>> ranking = dse.open(".").designs["acc_vehicle"].best("sum(cost)", n=2)
    >>> ranking[0].id, ranking.texts()
    ('lmhuzsgxvx', [['5150 EUR'], ['5165 EUR']])
    """

    def __init__(self, opened: OpenedSpace, aims: Sequence[Aim], entries: Sequence[Ranked]) -> None:
        self.opened = opened
        self.aims = tuple(aims)
        self._entries = tuple(entries)

    @cached_property
    def units(self) -> tuple[Unit, ...]:
        """The unit each aim is shown in."""
        return tuple(self.opened.unit_of(aim) for aim in self.aims)

    def shown(self) -> list[list[float]]:
        """The values of each entry in `units`."""
        return [
            [unit.from_si(float(value)) for unit, value in zip(self.units, entry.values, strict=True)]
            for entry in self._entries
        ]

    def texts(self) -> list[list[str]]:
        """The same with their units."""
        return [
            [f"{value:.6g} {unit}".rstrip() for value, unit in zip(row, self.units, strict=True)]
            for row in self.shown()
        ]

    def to_pandas(self) -> pd.DataFrame:
        """A row for each entry by its id: the aims in `units` (``frame.attrs["units"]``), then what is chosen where."""
        import pandas as pd

        names = [str(aim) for aim in self.aims]
        rows = [
            {**dict(zip(names, values, strict=True)), **entry.choices}
            for entry, values in zip(self._entries, self.shown(), strict=True)
        ]
        frame = pd.DataFrame(rows, pd.Index([entry.id for entry in self._entries], name="id"))
        frame.attrs["units"] = {name: str(unit) for name, unit in zip(names, self.units, strict=True)}
        return frame

    def __len__(self) -> int:
        return len(self._entries)

    def __iter__(self) -> Iterator[Ranked]:
        return iter(self._entries)

    @overload
    def __getitem__(self, place: int) -> Ranked: ...
    @overload
    def __getitem__(self, place: slice) -> Sequence[Ranked]: ...
    def __getitem__(self, place: int | slice) -> Ranked | Sequence[Ranked]:
        return self._entries[place]

    def __repr__(self) -> str:
        return f"<Ranking of {self.opened.title()}: {', '.join(' '.join(row) for row in self._rows())}>"

    def _repr_html_(self) -> str:
        return table(self.opened.title(), ("id", *map(str, self.aims)), self._rows())

    def _rows(self) -> list[list[str]]:
        return [[entry.id, *texts] for entry, texts in zip(self._entries, self.texts(), strict=True)]
