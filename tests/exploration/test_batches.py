from __future__ import annotations

from fake_runners import study_of
from first_asks import first_ask
from hypothesis import given, strategies as st

from dse.domain.run import RunRequest
from dse.exploration.batches import Chunks, Numbers
from dse.exploration.supervision.work_queue import WorkQueue
from dse.exploration.work import Batch
from dse.storage.database.sampler_requests import Block, SamplerRequests, blocks_of


def asked(levels: int, variables: int, names: tuple[str, ...] = ("a",)) -> Chunks:
    made = first_ask(study_of(levels=levels, variables=variables), names)
    return Chunks(dict(enumerate(made)), SamplerRequests(blocks_of(made, 0, 0)), {}.get)


@given(st.integers(1, 80), st.integers(1, 40))
def test_chunks_hold_every_run_once_and_one_configuration_each(points: int, configurations: int) -> None:
    chunks = asked(points, 1, tuple(f"c{i}" for i in range(configurations)))
    made = chunks.requests
    cut = list(chunks.runs(made))
    assert [request for batch in cut for request in batch.requests] == list(made.values())
    assert all(made[number].configuration == batch.configuration for batch in cut for number in batch.numbers)
    assert all(len(batch.numbers) <= 32 for batch in cut)


def test_a_small_study_is_cut_fine_enough_for_many_workers() -> None:
    chunks = asked(25, 2)
    assert len(list(chunks.runs(chunks.requests))) >= 64


def test_what_is_finished_is_not_planned_again_and_chunks_stay_where_they_were() -> None:
    chunks = asked(64, 2)
    every = {batch.identity: set(batch.numbers) for batch in chunks.runs(chunks.requests)}
    finished = set(range(0, 4096, 2)) | set(range(32, 64))
    for batch in chunks.runs(set(chunks.requests) - finished):
        assert set(batch.numbers) == every[batch.identity] - finished
        assert not batch.keep
    assert 32 not in {batch.identity for batch in chunks.runs(set(chunks.requests) - finished)}
    assert list(chunks.runs(set())) == []


def test_a_waveform_file_is_named_after_its_chunk_and_written_whole() -> None:
    chunks = asked(64, 2)
    (batch,) = chunks.waveforms({40}, {33: "runs-00000032-00000063.parquet", 41: ""})
    assert batch.file == "runs-00000032-00000063.parquet"
    assert batch.numbers == (33, 40)
    assert list(chunks.waveforms(set(), {33: "runs-00000032-00000063.parquet"})) == []


def test_a_later_ask_has_chunks_of_its_own_whatever_came_before() -> None:
    asks = SamplerRequests([Block(0, 2048, "a", 0, 0), Block(2048, 100, "a", 1, 0), Block(2148, 50, "b", 1, 0)])
    assert asks.chunk(2047) == (2016, 2047)
    # The second ask is of 150 runs: two to a chunk, and a configuration begins a new one.
    assert asks.chunk(2048) == (2048, 2049)
    assert asks.chunk(2149) == (2148, 2149)
    assert asks.chunk(2197) == (2196, 2197)


NUMBERS = st.lists(st.integers(0, 300), max_size=20)


@given(NUMBERS, NUMBERS, NUMBERS)
def test_numbers_are_a_set_in_ascending_order(first: list[int], more: list[int], others: list[int]) -> None:
    numbers, like = Numbers(first), set(first) | set(more)
    numbers.update(iter(more))
    assert list(numbers) == sorted(like)
    assert len(numbers) == len(like)
    assert list(numbers - Numbers(others)) == sorted(like - set(others))
    assert list(numbers & Numbers(others)) == list(numbers & set(others)) == sorted(like & set(others))
    assert all((number in numbers) is (number in like) for number in (-1, *range(302)))


def test_a_worker_stays_with_the_configuration_it_has_loaded() -> None:
    queue = WorkQueue(None, None)
    queue.fill(Batch(n, name, (RunRequest(n, name, {}),)) for n, name in enumerate("aaabbbcc"))
    loaded = {"first": "", "second": ""}
    taken: dict[str, str] = {"first": "", "second": ""}
    for _ in range(4):
        for worker, other in (("first", "second"), ("second", "first")):
            batch = queue.take(fresh=False, loaded=loaded[worker], others={loaded[other]})
            loaded[worker] = batch.configuration
            taken[worker] += batch.configuration
    assert taken == {"first": "aaac", "second": "bbbc"}


def test_batches_are_made_as_they_are_needed() -> None:
    made = []
    queue = WorkQueue(None, None)
    queue.fill(made.append(n) or Batch(n, "a", (RunRequest(n, "a", {}),)) for n in range(5000))
    assert [queue.take(fresh=False).identity for _ in range(10)] == [*range(10)]
    assert 1000 <= len(queue) + 10 == len(made) < 1100
    assert queue.numbers() == {*range(10, 5000)}
    assert [queue.take(fresh=False).identity for _ in range(len(queue))] == [*range(10, 5000)]
