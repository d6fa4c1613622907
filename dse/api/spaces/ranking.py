"""Configurations ranked by objectives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, overload

from dse.api.showing.html import table

if TYPE_CHECKING:
    import pandas as pd

    from dse.space import Aim, OpenedSpace, Ranked
    from dse.units import Unit


class Ranking(Sequence["Ranked"]):
    """The best under *aims*, best first, or a Pareto set, ascending by the first aim.

    Each entry has ``id``, ``choices`` and ``values``, exact and in SI, one for each aim.
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
        frame.attrs["units"] = {name: unit.symbol for name, unit in zip(names, self.units, strict=True)}
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
