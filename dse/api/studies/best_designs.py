"""What a study tells, for notebooks: its best designs with their units, and its findings."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Self

from dse.analysis import Choice, Finding, Ranking, claim
from dse.api.presentation.choice_text import choice_lines
from dse.api.presentation.definition_rows import ranking_as_data
from dse.api.presentation.html import table
from dse.storage import headed, titles_of

if TYPE_CHECKING:
    import pandas as pd

    from dse.domain.definition import StudyDefinition


class _OfStudy:
    """A noun of the analysis with the *definition* of its study, which has the units of its numbers."""

    __slots__ = ()

    @classmethod
    def of(cls, plain: Choice | Ranking, definition: StudyDefinition) -> Self:
        """*plain*, whose numbers have the units of *definition*."""
        made = cls(*(getattr(plain, field.name) for field in fields(plain)))
        object.__setattr__(made, "definition", definition)  # what is frozen is set once
        return made


class BestDesigns(_OfStudy, Ranking):
    """A ranking of designs of the study *definition*: see `dse.analysis.Ranking`. Notebooks show it as a table."""

    __slots__ = ("definition",)
    definition: StudyDefinition

    def to_pandas(self, units: str = "shown") -> pd.DataFrame:
        """A row for each of the best designs by its place: its configuration with choices, design variables, objectives
        and margins (``R1.margin``), and the numbers of its runs.

        Numbers are in the units that the report shows, or with *units* ``si`` in SI. ``frame.attrs["units"]`` has them,
        ``frame.attrs["titles"]`` what columns are called.
        """
        import pandas as pd

        data = ranking_as_data(self, self.definition, units)
        names = [f"sum({each.name})" if each.is_total else each.name for each in self.objectives]
        rows = [
            {
                "configuration": each["configuration"],
                **self.definition.configuration(each["configuration"]).choices,
                **each["point"],
                **dict(zip(names, each["values"], strict=True)),
                **{f"{name}.margin": margin for name, margin in each["margins"].items()},
                "runs": each["runs"],
            }
            for each in data["best"]
        ]
        frame = pd.DataFrame(rows, pd.RangeIndex(1, len(rows) + 1, name="place"))
        frame.attrs["units"] = {name: unit for name, unit in data["units"].items() if name in frame.columns}
        frame.attrs["titles"] = titles_of(self.definition, frame.columns)
        return frame

    def __repr__(self) -> str:
        named = (f"{each.configuration} (run {each.runs[0]})" for each in self.best)
        return f"<{self._words()}: {', '.join(named) or 'none'}>"

    def _repr_html_(self) -> str:
        frame = self.to_pandas()
        headings = headed(frame.columns, frame.attrs["units"])
        return table(self._words(), ["", *headings], ([row[0], *map(_cell, row[1:])] for row in frame.itertuples()))

    def _words(self) -> str:
        return f"{claim(self)}; {' and '.join(map(str, self.objectives)) or 'by their least margin'}"


class DesignChoice(_OfStudy, Choice):
    """Which design of the study *definition* to take: see `dse.analysis.Choice`. Notebooks show it in sentences."""

    __slots__ = ("definition",)
    definition: StudyDefinition

    def __repr__(self) -> str:
        name, lines = choice_lines(self, self.definition)
        return "\n".join([name, *(f"{label}: {text}" for label, text in lines)])

    def _repr_html_(self) -> str:
        return table(choice_lines(self, self.definition)[0], (), choice_lines(self, self.definition)[1])


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)


class Findings(tuple[Finding, ...]):
    """Findings in the order in which they are told. Notebooks show them as a table."""

    __slots__ = ()

    def __repr__(self) -> str:
        return "\n".join(f"{each.topic}: {each.text}" for each in self) or "<no findings>"

    def _repr_html_(self) -> str:
        return table("Findings", ("about", "finding"), ((each.topic, each.text) for each in self))
