"""A bench in two halves gives what the whole bench gives, bit for bit."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from answerers import Proxy
from background import LIMIT, in_background
from live.worlds import bench_of, digest, far_of, near_of, run_of, served, whole_of

from dse.api import serve_bench
from dse.domain.bench import TestBench
from dse.domain.run import Outcome
from dse.errors import DseError
from dse.live import What, serve_world
from dse.testbench import PreparedBench

SHORT = 1.0


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="module")
def bench() -> TestBench:
    return bench_of("acc_following", SHORT)


@pytest.fixture(scope="module")
def whole(bench: TestBench, cache: Path) -> PreparedBench:
    return whole_of(bench, cache)


@pytest.fixture(scope="module")
def far(bench: TestBench, port: int, cache: Path) -> PreparedBench:
    return far_of(bench, port, None, cache)


@pytest.fixture(scope="module")
def near(bench: TestBench, port: int, cache: Path) -> PreparedBench:
    return near_of(bench, port, None, cache)


def test_both_halves_give_what_the_whole_gives(whole, near, far):
    for _ in range(2):
        with served(far):
            run = run_of(near)
        assert (run.outcome, run.problem) == (Outcome.DONE, "")
        assert digest(run) == digest(run_of(whole))


def test_loss_doubling_and_reordering_change_nothing(whole, bench, port, far, cache):
    with Proxy(port, seed=1) as proxy, served(far):
        run = run_of(near_of(bench, proxy.port, None, cache))
    assert min(proxy.lost, proxy.doubled, proxy.delayed) > 0
    assert digest(run) == digest(run_of(whole))


@pytest.mark.parametrize(
    ("parameters", "parts", "told"),
    [
        ({"world.lead_speed": 3.0}, None, "of another layout"),
        pytest.param(
            {},
            ("world", "sensor"),
            "of a wrong size (the last of 124 bytes, right are 148)",
            marks=pytest.mark.thorough,
        ),
    ],
)
def test_another_world_is_refused_by_what_differs(bench, port, near, far, cache, parameters, parts, told):
    """Other values of the world make another layout number, other parts another size."""
    other = replace(bench, parameters={**bench.parameters, **parameters})
    with served(far):
        for wait in (0.1, 3.0, 30.0):  # longer, if the world was too busy to be asked
            refused = run_of(near_of(other, port, parts, cache, wait=wait)).problem
            if told in refused:
                break
        assert run_of(near).outcome is Outcome.DONE
    assert refused.startswith("world: ")
    assert told in refused


def test_a_world_that_ends_ends_the_run_with_the_rows_until_then(bench, port, near, cache):
    far = far_of(replace(bench, simulation=replace(bench.simulation, stop=0.5)), port, None, cache)
    with served(far):
        run = run_of(near)
    assert (run.outcome, run.waveforms.time[-1]) == (Outcome.DONE, pytest.approx(0.5))
    assert "world: fmi2DoStep at t = 0.5" in run.problem
    assert "asked to end the simulation" in run.problem


@pytest.mark.parametrize(
    ("answers", "listen", "said"),
    [
        ("192.168.1.30:5006", "127.0.0.1", "'192.168.1.30' is not a loopback address.*--listen"),
        ("vehicle:5006", "127.0.0.1", "'vehicle' is not a loopback address.*--listen"),
        ("[::1]:5006", "127.0.0.1", "are not both IPv4 or both IPv6"),
        (
            "127.0.0.1:5005",
            "127.0.0.1",
            "the world itself listens at 127.0.0.1:5005.*port at which the client receives",
        ),
        ("127.0.0.1", "127.0.0.1", "'127.0.0.1' is not a HOST:PORT.*127.0.0.1:5005"),
        ("127.0.0.1:0", "127.0.0.1", "'127.0.0.1:0' is not a HOST:PORT"),
    ],
)
def test_answers_do_not_leave_the_machine_unless_the_world_listens_there(bench, answers, listen, said):
    with pytest.raises(DseError, match=f"(?s)--answers: .*{said}"):
        serve_bench(bench, None, {}, port=5005, listen=listen, answers=answers)


@pytest.mark.thorough
def test_a_world_that_is_killed_fails_the_run_by_name_and_the_next_one_is_served(port, cache):
    bench = bench_of("acc_following", 600.0)
    near = near_of(bench, port, None, cache, timeout=0.5)
    with closing(serve_world(far_of(bench, port, None, cache))) as news, in_background(run_of, near) as running:
        assert next(news).what is What.CONNECTED
        news.close()
        run = running.result(LIMIT)
    assert run.outcome is Outcome.FAILED
    assert run.problem.startswith("world: fmi2DoStep at t = ")
    assert f"in 0.5 s no packet that can be used came from 127.0.0.1:{port}" in run.problem


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("acc_following", None),
        ("acc_following", ("world", "sensor")),
        ("road_following", None),
        ("road_following", ("chassis", "road", "traffic", "scene")),
        ("highway_following", None),
        ("electric_acc_motorway", None),
    ],
)
def test_benches_give_the_same_in_two_halves(name, parts, port, cache):
    bench = bench_of(name)
    expected, far, near = (
        digest(run_of(whole_of(bench, cache))),
        far_of(bench, port, parts, cache),
        near_of(bench, port, parts, cache),
    )
    with served(far):
        assert digest(run_of(near)) == expected


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["acc_following", "road_following"])
def test_twenty_runs_of_twenty_are_the_same_and_so_are_those_over_a_bad_line(name, port, cache):
    bench = bench_of(name)
    expected, far, near = (
        digest(run_of(whole_of(bench, cache))),
        far_of(bench, port, None, cache),
        near_of(bench, port, None, cache),
    )
    for _ in range(20):
        with served(far):
            assert digest(run_of(near)) == expected
    with Proxy(port, seed=2) as proxy, served(far):
        assert digest(run_of(near_of(bench, proxy.port, None, cache))) == expected
    assert min(proxy.lost, proxy.doubled, proxy.delayed) > 100
