"""Two or more studies side by side: what changed, and which verdicts flipped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.api.presentation.quantities import quantity, units_called
from dse.domain.bench import VERDICTS, Verdict
from dse.errors import fail
from dse.storage import RunTable, Scale, StudyFolder, changed_study, over_draws, scales_of

if TYPE_CHECKING:
    from dse.domain.component import Value
    from dse.domain.definition import StudyDefinition


@dataclass(frozen=True, slots=True)
class Flip:
    """A run of the first study and the one of another with the same configuration and point (SI), whose verdicts on
    *requirement* differ; numbers, verdicts and margins (SI) of both, the first study's first."""

    requirement: str
    configuration: str
    point: Mapping[str, Value]
    numbers: tuple[int, int]
    verdicts: tuple[Verdict, Verdict]
    margins: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Compared:
    """A study compared with the first one; the first one is compared with itself.

    It is in *folder* and defined by *definition*. *finished* of its *runs* exist; *verdicts* counts their verdicts by
    requirement. *changed* describes the differences of its definition. *shared* runs have the configuration and point
    of a run of the first study; *flips* are the verdicts that differ in them.
    """

    folder: Path
    definition: StudyDefinition
    runs: int
    finished: int
    verdicts: Mapping[str, Mapping[str, int]]
    changed: tuple[str, ...]
    shared: int
    flips: tuple[Flip, ...]


def compare(folders: Sequence[str | Path]) -> tuple[Compared, ...]:
    """Compare each study of *folders* with the first. Raises DseError for fewer than two, or an unreadable one.

    >>> first, second = dse.compare(["out/gains", "out/gains"])
    >>> second.changed, second.flips
    ((), ())
    """
    if len(folders) < 2:
        raise fail("two studies or more can be compared", hint="name the study folders")
    first: RunTable | None = None
    found = []
    for folder in map(Path, folders):
        with StudyFolder.snapshot(folder) as store:
            store.require_definition()
            table = over_draws(store.table())
        first = first or table
        found.append(_compared(folder, first, table))
    return tuple(found)


def comparison_as_data(comparison: Sequence[Compared], units: str = "shown") -> list[dict[str, object]]:
    """*comparison* as plain data, its points and margins in these *units*."""
    return [_as_data(each, scales_of(each.definition, units_called(units))) for each in comparison]


def _as_data(compared: Compared, scales: Mapping[str, Scale]) -> dict[str, object]:
    return {
        "folder": compared.folder.as_posix(),
        "study": compared.definition.study,
        "title": compared.definition.title,
        "runs": compared.runs,
        "finished": compared.finished,
        "verdicts": {name: dict(counts) for name, counts in compared.verdicts.items()},
        "changed": list(compared.changed),
        "shared": compared.shared,
        "units": {name: scale.symbol for name, scale in scales.items() if scale.symbol},
        "flips": [
            {
                "requirement": flip.requirement,
                "configuration": flip.configuration,
                "point": {name: scales[name].number(value) for name, value in flip.point.items()},
                "runs": list(flip.numbers),
                "verdicts": [str(verdict) for verdict in flip.verdicts],
                "margins": [scales[f"{flip.requirement}.margin"].of(margin) for margin in flip.margins],
            }
            for flip in compared.flips
        ],
    }


def flip_counts(compared: Compared) -> Mapping[tuple[str, Verdict, Verdict], int]:
    """How many runs went from one verdict to another, by requirement, the most frequent first."""
    return dict(Counter((flip.requirement, *flip.verdicts) for flip in compared.flips).most_common())


def _compared(folder: Path, first: RunTable, table: RunTable) -> Compared:
    header = table.header
    verdicts = {name: _counted(table.verdicts(name).tolist()) for name in header.requirements}
    if first is table:
        return Compared(folder, header.definition, header.runs, len(table), verdicts, (), len(table), ())
    pairs = _same_runs(first, table)
    before, after = first.header.definition, header.definition
    changed = (*_renamed(before, after), *(_in_words(each, before, after) for each in changed_study(before, after)))
    flips = (*_flips(first, table, pairs),)
    return Compared(folder, header.definition, header.runs, len(table), verdicts, changed, len(pairs), flips)


def _counted(codes: Sequence[int]) -> dict[str, int]:
    counts = Counter(codes)
    counted = ((code, verdict) for code, verdict in enumerate(VERDICTS) if verdict is not Verdict.NOT_APPLICABLE)
    return {str(verdict): counts[code] for code, verdict in counted}


def _renamed(before: StudyDefinition, after: StudyDefinition) -> Iterator[str]:
    for what in ("bench", "design"):
        was, now = getattr(before, what).name, getattr(after, what).name
        if was != now:
            yield f"{what}: {was} became {now}"


def _in_words(change: str, before: StudyDefinition, after: StudyDefinition) -> str:
    """*change* as `changed_study` has it; of a requirement or metric with what it was and is."""
    what, _, name = change.partition(" ")
    tell = {"requirement": _bounds, "metric": _formula}.get(what)
    if tell is None:
        return change
    was, now = tell(before, name), tell(after, name)
    return f"{change} {'is new' if not was else 'is gone' if not now else f': {was} became {now}'}".replace(" :", ":")


def _bounds(definition: StudyDefinition, name: str) -> str:
    for each in definition.requirements:
        if each.name == name:
            bounds = ((each.at_most, "\u2264"), (each.at_least, "\u2265"))
            told = " and ".join(f"{sign} {quantity(bound, each.unit)}" for bound, sign in bounds if bound is not None)
            return f"{each.metric} {told}" + (f" when {each.exercised_when}" if each.exercised_when else "")
    return ""


def _formula(definition: StudyDefinition, name: str) -> str:
    return next((each.expression for each in definition.metrics if each.name == name), "")


def _same_runs(first: RunTable, other: RunTable) -> list[tuple[int, int]]:
    """Rows of both with the same configuration and point. A variable of one study is a constant of the other's."""
    names = sorted({*first.header.variables, *other.header.variables})
    rows: dict[tuple[Any, ...], int] = {}
    for row, key in enumerate(_keys(first, names)):
        rows.setdefault(key, row)
    return [(rows[key], row) for row, key in enumerate(_keys(other, names)) if key in rows]


def _keys(table: RunTable, names: Sequence[str]) -> Iterator[tuple[Any, ...]]:
    constants = {each.id: each.constants for each in table.header.definition.configurations}
    columns = []
    for name in names:
        if name in table.points:
            # What is not a number is a variable that the configuration does not have.
            columns.append([v if v == v else None for v in table.points[name].tolist()])  # noqa: PLR0124
        else:
            columns.append([constants[each].get(name) for each in table.configurations])
    return zip(table.configurations, *columns, strict=True)


def _flips(first: RunTable, other: RunTable, pairs: Sequence[tuple[int, int]]) -> Iterator[Flip]:
    points = [request.point for request in other.requests()] if pairs else []
    for name in first.header.requirements:
        if name not in other.header.requirements:
            continue
        tables = first, other
        codes = [table.verdicts(name).tolist() for table in tables]
        margins = [table.margins(name).tolist() for table in tables]
        numbers = [table.numbers.tolist() for table in tables]
        for was, now in pairs:
            if codes[0][was] != codes[1][now]:
                yield Flip(
                    name,
                    other.configurations[now],
                    points[now],
                    (numbers[0][was], numbers[1][now]),
                    (VERDICTS[codes[0][was]], VERDICTS[codes[1][now]]),
                    (margins[0][was], margins[1][now]),
                )
