"""Studies that find some of their runs made already."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dse_example.bisection import Bisection
from fake_runners import benches, definition_of, make_fake, study_of

from dse.domain.address import Address
from dse.domain.run import RunRequest
from dse.domain.study import Keep, Study
from dse.exploration import KnownRuns, give, known_runs
from dse.exploration.executors.local import Local
from dse.exploration.loop import Explored, explore
from dse.storage import RunStore, StudyFolder
from dse.storage.export.tables import to_csv

NAMES = ("a", "b")
KEPT = ("world.speed", "world.gap")


def address(name: str) -> Address:
    values = np.array([0.3, 0.3, 5.0], dtype="<f8").tobytes()
    return Address(f"key{name}", ("part.x0", "part.x1", "part.y"), values, {"part.x0": (0,), "part.x1": (1,)}, "here")


def run(path: Path, study: Study, *, reads: bool = True, turned: bool = False, **mischief: Any) -> Explored:
    """Explore into *path* with the store beside it; *turned* has metrics and requirements the other way round."""
    definition = definition_of(study, NAMES)
    if turned:
        definition = replace(definition, metrics=definition.metrics[::-1], requirements=definition.requirements[::-1])
    with StudyFolder.resume(path, definition) as folder:
        folder.note_addresses({name: address(name) for name in NAMES})
        known = KnownRuns(
            RunStore(path.parent / "runs"),
            {name: address(name) for name in NAMES},
            folder.header.measures,
            dict.fromkeys(NAMES, KEPT),
            reads=reads,
        )
        return explore(
            study,
            benches(*NAMES, **mischief),
            folder,
            executor=Local(workers=1),
            make_runner=make_fake,
            known=known,
        )


def content(path: Path) -> tuple[bytes, dict[str, bytes]]:
    with StudyFolder.open(path) as folder:
        files = {file.name: file.read_bytes() for file in folder.waveform_folder.iterdir()}
        return to_csv(folder), files


@pytest.mark.thorough
@pytest.mark.sampled(3)
@pytest.mark.parametrize("keep", list(Keep))
def test_a_study_that_was_made_before_is_taken_whole(tmp_path: Path, keep: Keep, monkeypatch: Any) -> None:
    study = study_of(levels=6, keep=keep)
    first = run(tmp_path / "one", study)
    assert first.taken == 0

    def refuse(*_: object) -> None:
        raise AssertionError("a worker was started")

    monkeypatch.setattr("dse.exploration.supervision.supervisor.WorkerProcess", refuse)
    second = run(tmp_path / "two", study)
    assert (second.taken, second.simulated, second.kept) == (72, 0, first.kept)
    assert content(tmp_path / "one") == content(tmp_path / "two")


@pytest.mark.thorough
def test_runs_that_another_study_makes_meanwhile_are_taken_with_their_rows(tmp_path: Path, monkeypatch: Any) -> None:
    study = study_of(levels=3, keep=Keep.ALL)
    run(tmp_path / "one", study)
    rows, asked = KnownRuns.rows, []

    def late(known: KnownRuns, requests: Any) -> Any:
        asked.append(list(requests))
        return rows(known, asked[-1] if len(asked) > 1 else ())

    monkeypatch.setattr(KnownRuns, "rows", late)
    second = run(tmp_path / "two", study)
    assert (second.runs, second.taken, second.simulated) == (18, 18, 0)
    assert content(tmp_path / "one") == content(tmp_path / "two")


@pytest.mark.thorough
def test_a_sampler_that_looks_at_results_is_told_what_was_known(tmp_path: Path) -> None:
    study = study_of(Bisection(requirement="R1", width=0.01), keep=Keep.ALL)
    first = run(tmp_path / "one", study)
    second = run(tmp_path / "two", study)
    assert (second.runs, second.taken, second.simulated) == (first.runs, first.runs, 0)
    assert content(tmp_path / "one") == content(tmp_path / "two")


@pytest.mark.thorough
def test_only_what_is_missing_is_simulated(tmp_path: Path) -> None:
    run(tmp_path / "few", study_of(levels=3))
    study = study_of(levels=5)
    many = run(tmp_path / "many", study)
    assert (many.runs, many.taken, many.simulated) == (50, 18, 32)
    run(tmp_path / "fresh", study, reads=False)
    assert content(tmp_path / "many") == content(tmp_path / "fresh")


@pytest.mark.thorough
def test_the_order_of_metrics_and_requirements_may_be_another(tmp_path: Path) -> None:
    study = study_of(levels=4)
    run(tmp_path / "one", study)
    assert run(tmp_path / "two", study, turned=True).simulated == 0
    run(tmp_path / "fresh", study, turned=True, reads=False)
    assert content(tmp_path / "two") == content(tmp_path / "fresh")


@pytest.mark.thorough
@pytest.mark.sampled(3)
@pytest.mark.parametrize("mischief", ["fails", "raises", "crashes"])
def test_runs_that_failed_are_simulated_again(tmp_path: Path, mischief: str) -> None:
    study = study_of(levels=3)
    assert run(tmp_path / "one", study, mischief=mischief, when=(4,)).failed == 1
    healed = run(tmp_path / "two", study)
    assert (healed.failed, healed.taken, healed.simulated) == (0, 17, 1)


@pytest.mark.thorough
def test_a_run_that_gave_another_result_the_second_time_is_not_taken(tmp_path: Path) -> None:
    study = study_of(levels=8, keep=Keep.NEAR_BOUNDARY)
    odd = run(tmp_path / "one", study, mischief="drifts").irreproducible
    assert odd > 0
    with StudyFolder.open(tmp_path / "one") as folder:
        give(folder, RunStore(tmp_path / "runs"))
    assert run(tmp_path / "two", replace(study, keep=Keep.NONE)).taken == 128 - odd


@pytest.mark.thorough
def test_a_chunk_of_which_one_waveform_is_lost_is_simulated(tmp_path: Path) -> None:
    study = study_of(levels=8, keep=Keep.ALL)
    run(tmp_path / "one", study)
    (lost, *_) = sorted((tmp_path / "one" / "waveforms").iterdir())
    lost.write_bytes(lost.read_bytes()[:-1])
    again = run(tmp_path / "two", study)
    assert again.taken == 128
    assert 0 < again.simulated < 128
    run(tmp_path / "fresh", study, reads=False)
    assert content(tmp_path / "two") == content(tmp_path / "fresh")


@pytest.mark.thorough
def test_a_folder_gives_all_it_has(tmp_path: Path) -> None:
    study = study_of(levels=4, keep=Keep.ALL)
    run(tmp_path / "one" / "study", study, mischief="fails", when=(3,))
    store = RunStore(tmp_path / "runs")
    with StudyFolder.open(tmp_path / "one" / "study") as folder:
        give(folder, store)
        names = address("a").of(("part.x0", "part.x1"), np.array([[0.0, 0.0], [1.0, 1.0]]))
        before = store.places(address("a").entry, names)
        give(folder, store)
        assert store.places(address("a").entry, names) == before != [None, None]
    StudyFolder.discard(tmp_path / "one" / "study")
    taken = run(tmp_path / "two", study)
    assert (taken.taken, taken.failed) == (31, 0)


def test_requests_are_looked_up_a_part_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(known_runs, "_AT_ONCE", 10)
    taken: list[RunRequest] = []

    def requests() -> Iterator[RunRequest]:
        for number in range(35):
            taken.append(RunRequest(number, NAMES[number % 2], {}))
            yield taken[-1]

    parts = known_runs._parts(requests())
    first = next(parts)
    assert len(taken) == 10  # the others are not there yet: as nouns, a million would take half a gigabyte
    found = [first, *parts]
    assert max(map(len, found)) <= 10
    assert all(len({request.configuration for request in part}) == 1 for part in found)
    assert sorted(request.number for part in found for request in part) == list(range(35))
