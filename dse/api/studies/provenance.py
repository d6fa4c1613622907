"""What is kept with a study besides its results: its files as they are run, and what its design space holds."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.provenance import Absent, Funnel, Left, Provenance, SourceText, digest_of
from dse.errors import DseError, is_gone

if TYPE_CHECKING:
    from dse.domain.study import Study
    from dse.errors import Location
    from dse.space import OpenedSpace
    from dse.storage import StudyFolder

_LONGEST = 1_000_000
_MOST_ABSENT = 30
_ABSENT = "absent"


def note_sources(study: Study, store: StudyFolder) -> None:
    """Keep the files of *study* as they are; what was known of its design space goes if one of them has changed."""
    sources, known = tuple(_sources(study)), store.notes()
    if known is None or known.sources != sources:
        store.note(Provenance(sources))


def note_space(study: Study, store: StudyFolder) -> None:
    """Keep what the constraints leave of the design space, if that is not known already."""
    known = store.notes() or Provenance()
    if known.funnel is None and not known.unfunnelled:
        try:
            notes = Provenance(known.sources, _funnel(study))
        except DseError as error:
            notes = Provenance(known.sources, None, error.problems[0].what)
        store.note(notes)


def _sources(study: Study) -> Iterator[SourceText]:
    places = [("study", study.where), *(("test bench", bench.where) for bench in study.benches)]
    found = [(kind, _file(where)) for kind, where in [*places, ("design space", study.bench.design.where)]]
    told: set[Path] = set()
    for kind, file in found:
        if file is None or file in told:
            continue
        told.add(file)
        try:
            if file.stat().st_size > _LONGEST:
                continue
            text = file.read_bytes().decode("utf-8")
        except ValueError:
            continue  # no text: there is nothing that could be shown
        except OSError as error:
            if is_gone(error):  # of a package
                continue
            raise
        yield SourceText(kind, file.name, text, digest_of(text))


def _file(where: Location | None) -> Path | None:
    return Path(where.file) if where and where.file else None


def _funnel(study: Study) -> Funnel:
    from dse.space import open_space

    design = study.bench.design
    opened = open_space(design)
    total = opened.count_unconstrained()
    steps = tuple(
        Left(constraint.name, constraint.because, constraint.rule.text.strip(), _number(left.value), str(left))
        for constraint, left in zip(design.constraints, opened.funnel(), strict=True)
    )
    return Funnel(design.name, _number(total.value), str(total), steps, tuple(_absent(opened)))


def _absent(opened: OpenedSpace) -> Iterator[Absent]:
    dead = [each for each in opened.occurrences() if each.dead]
    for each in dead[:_MOST_ABSENT]:
        choice = each.choice or _ABSENT
        conflict = opened.explain([f"{each.path}={choice}"]).conflict
        yield Absent(each.path, choice, tuple(constraint.name for constraint in conflict))


def _number(count: int) -> float:
    return float(min(count, 10**300))
