"""What a study has come to, at a glance: counted by the database, quick also where there are many runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from dse.domain.bench import VERDICTS, Verdict, overall_verdict
from dse.domain.study import SHARD_FOLDER
from dse.storage import StudyFolder, Writer, writer_of


@dataclass(frozen=True, slots=True)
class StudySummary:
    """*finished* of *runs* that were asked for; *verdicts* counts them by the verdict on all requirements.

    *state* is as `state_of` tells, *changed* when the folder was last written to.
    """

    study: str
    title: str
    bench: str
    design: str
    runs: int
    finished: int
    configurations: int
    requirements: int
    verdicts: Mapping[Verdict, int]
    state: str
    changed: datetime


def study_summary(folder: str | Path) -> StudySummary:
    """The study in *folder*. Raises DseError if it is none, or damaged."""
    path = Path(folder)
    with StudyFolder.snapshot(path) as store:
        definition, runs = store.header.definition, store.header.runs
        counts = store.verdicts()
        finished = store.count()
    return StudySummary(
        definition.study,
        definition.title or definition.study,
        definition.bench.title or definition.bench.name,
        definition.design.name,
        runs,
        finished,
        len(definition.configurations),
        len(definition.requirements),
        _overall(counts, finished),
        state_of(path, runs, finished, writer_of(path)),
        _changed(path),
    )


def state_of(folder: Path, runs: int, finished: int, writer: Writer | None) -> str:
    """``running``, ``finished`` or ``interrupted``; ``at rest`` for a shard, of which that cannot be told."""
    if writer:
        return "running"
    if finished >= runs:
        return "finished"
    return "at rest" if is_shard(folder) else "interrupted"


def is_shard(folder: Path) -> bool:
    """Whether only a part of a study's runs is to be made in *folder*."""
    return bool(SHARD_FOLDER.fullmatch(folder.name))


def _overall(counts: Mapping[tuple[str, ...], int], finished: int) -> Mapping[Verdict, int]:
    found: Counter[Verdict] = Counter()
    for verdicts, count in counts.items():
        found[overall_verdict(verdicts)] += count
    found[Verdict.FAILED_TO_RUN] += finished - found.total()  # of a study without requirements
    return {verdict: found[verdict] for verdict in VERDICTS}


def _changed(path: Path) -> datetime:
    """When the newest of the files that a run writes was written."""
    times = [each.stat().st_mtime for each in path.glob("study.sqlite*")]
    return datetime.fromtimestamp(max(times, default=0.0), UTC)
