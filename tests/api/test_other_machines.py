"""A study made by executors of other packages, with workers that have nothing in their cache and are killed.

All are *fresh*: else they would take the runs that were made before.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import psutil
import pytest
from background import LIMIT
from example_study import small_study

import dse
from dse.domain.study import ExecutorChoice
from dse.exploration import Progress
from dse.storage import StudyFolder

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def study(folder: Path) -> dse.Study:
    (folder / "testbenches" / "middle.pet.yaml").write_text(
        small_study(20, 16).replace("study: small", "study: middle"), encoding="utf-8"
    )
    return dse.open(folder).studies["middle"]


@pytest.fixture(scope="module")
def local(study: dse.Study, tmp_path_factory: pytest.TempPathFactory) -> dse.Results:
    return study.explore(tmp_path_factory.mktemp("local") / "out", workers=1)


def is_the_same(made: dse.Results, local: dse.Results) -> bool:
    kept = [{p.name: p.read_bytes() for p in (each.folder / "waveforms").iterdir()} for each in (made, local)]
    return made.export("csv") == local.export("csv") and kept[0] == kept[1]


def set_cache(folder: str) -> None:
    os.environ["DSE_CACHE"] = folder


def pool(cache: Path, workers: int = 2) -> ProcessPoolExecutor:
    """Workers as on another host."""
    return ProcessPoolExecutor(workers, get_context("spawn"), set_cache, (str(cache),))


@pytest.mark.nightly
def test_workers_with_an_empty_cache_are_sent_what_they_lack(study, local, tmp_path: Path) -> None:
    with pool(tmp_path / "cache") as executor:
        made = study.explore(tmp_path / "out", executor=executor, fresh=True)
    assert is_the_same(made, local)
    assert [path.name for path in (tmp_path / "cache").iterdir()] == ["received"]
    with StudyFolder.open(tmp_path / "out") as stored:
        makers = {attempt.maker for attempt in stored.attempts()}
    assert makers
    assert f"{os.uname().nodename}/{os.getpid()}" not in makers


@pytest.mark.nightly
def test_a_pool_that_breaks_is_made_anew(study, local, tmp_path: Path) -> None:
    made_pools: list[ProcessPoolExecutor] = []

    def make() -> ProcessPoolExecutor:
        made_pools.append(pool(tmp_path / "cache"))
        return made_pools[-1]

    kill = once_there_are(20, lambda: os.kill(next(iter(made_pools[-1]._processes)), signal.SIGKILL))
    made = study.explore(tmp_path / "out", executor=make, fresh=True, progress=kill)
    assert len(made_pools) == 2
    assert is_the_same(made, local)
    assert made.summary.failed == 0


@pytest.mark.nightly
def test_loky_will_do(study, local, tmp_path: Path) -> None:
    from loky import get_reusable_executor

    with get_reusable_executor(max_workers=2) as executor:
        made = study.explore(tmp_path / "out", executor=executor, fresh=True)
    assert is_the_same(made, local)


def test_half_of_the_workers_of_a_dask_cluster_are_killed(study, local, tmp_path: Path) -> None:
    import distributed

    with (
        distributed.LocalCluster(
            n_workers=4, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        half = [psutil.Process(number) for number in [*client.run(os.getpid).values()][:2]]
        chosen = ExecutorChoice("dask", {"address": cluster.scheduler_address})
        over_dask = dse.Study.of(replace(study.noun, executor=chosen))
        kill = once_there_are(20, lambda: [process.kill() for process in half])
        made = over_dask.explore(tmp_path / "out", fresh=True, progress=kill)
        assert psutil.wait_procs(half, LIMIT)[1] == []
    assert is_the_same(made, local)
    assert made.summary.failed == 0


def once_there_are(runs: int, act: Callable[[], object]) -> Callable[[Progress], None]:
    """What calls *act* as soon as so many are stored, when it is told of progress."""
    waiting = [act]

    def told(progress: Progress) -> None:
        if progress.done >= runs and waiting:
            assert progress.done < progress.total
            waiting.pop()()

    return told
