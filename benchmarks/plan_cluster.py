"""Plans a large study: the scheduler of dse simulated, with costs that were measured, on a cluster that loses workers.

    python benchmarks/plan_cluster.py

Discrete events: workers come from a batch queue, carry out loads one after the other, and end at random; one
coordinator takes one answer at a time. docs/clusters.md has the table it prints.
"""

from __future__ import annotations

import heapq
import random
from collections import deque
from dataclasses import dataclass, replace

HOUR = 3600.0

# Of dse, as Dispatcher has them.
LOAD_SECONDS, LOADS_PER_SECOND, LARGEST_LOAD, DEPTH = 1.0, 50, 1000, 2


@dataclass(frozen=True)
class Costs:
    """Measured (docs/decisions/0019-other-machines.md); seconds of one core, and bytes."""

    send: float = 5.5e-3
    """Of the coordinator, to pack a load, send it and take its answer: 0.5 ms of dse, the rest of Dask's client."""
    row: float = 37e-6
    """Of the coordinator, to take and store a row."""
    trip: float = 16e-3
    """From the coordinator through a Dask scheduler to a worker and back, without waiting."""
    start: float = 2.0
    """Until a new worker has its process and its FMUs."""
    row_bytes: float = 175.0
    """Of the database, with 8 metrics and 2 requirements; attempts come to as much as a quarter of it."""
    travel_bytes: float = 170.0
    """Of a run on its way there and back; of a load beside its runs, *load_bytes*."""
    load_bytes: float = 1500.0
    fmu_bytes: float = 0.5e6
    waveform_bytes: float = 12e3


@dataclass(frozen=True)
class Case:
    name: str
    runs: int
    seconds: float
    workers: int
    per_host: int = 48
    spread: float = 0.2
    lost_after: float = 24 * HOUR
    """Mean time after which a worker is taken away or dies; another comes *again* seconds later."""
    again: float = 300.0
    arrive: float = 600.0
    """Workers come evenly within so many seconds."""


@dataclass
class Outcome:
    hours: float
    busy: float
    coordinator: float
    lost_runs: int
    loads: int


def simulate(case: Case, costs: Costs, seed: int = 1) -> Outcome:  # noqa: PLR0915  # one loop of events
    """One study, from its command to its last row."""
    dice = random.Random(seed)  # noqa: S311  # a simulation
    most = max(1, min(LARGEST_LOAD, int(max(LOAD_SECONDS, case.workers / LOADS_PER_SECOND) / case.seconds)))
    waiting: deque[int] = deque()
    """Loads that are at the scheduler, by their number of runs."""
    left, lost, loads, done = case.runs, 0, 0, 0
    busy = free_at = taken = 0.0
    at_hand: dict[int, tuple[int, float]] = {}
    events: list[tuple[float, int, str, int]] = []
    count = 0

    def at(time: float, what: str, worker: int) -> None:
        nonlocal count
        count += 1
        heapq.heappush(events, (time, count, what, worker))

    for worker in range(case.workers):
        at(case.arrive * (worker + 1) / case.workers, "comes", worker)
    alive: dict[int, int] = dict.fromkeys(range(case.workers), 0)
    idle: deque[int] = deque()
    present = 0
    now = 0.0

    def give(worker: int, now: float) -> None:
        nonlocal loads
        if not waiting:
            idle.append(worker)
            return
        runs = waiting.popleft()
        pace = case.seconds * (1 + case.spread * (2 * dice.random() - 1))
        at_hand[worker] = runs, now
        loads += 1
        at(now + costs.trip + runs * pace, f"done {alive[worker]}", worker)

    def refill(now: float) -> None:
        nonlocal left
        while left and len(waiting) + len(at_hand) < DEPTH * max(1, present):
            runs = min(most, left)
            left -= runs
            waiting.append(runs)
        while waiting and idle:
            give(idle.popleft(), now)

    while done < case.runs:
        now, _, what, worker = heapq.heappop(events)
        if what == "comes":
            present += 1
            at(now + costs.start + case.seconds, f"ready {alive[worker]}", worker)
            at(now + dice.expovariate(1 / case.lost_after), "ends", worker)
        elif what == "ends":
            present -= 1
            alive[worker] += 1
            if worker in at_hand:
                runs, since = at_hand.pop(worker)
                lost += min(runs, round((now - since) / case.seconds + 0.5))
                waiting.appendleft(runs)
            elif worker in idle:
                idle.remove(worker)
            at(now + case.again, "comes", worker)
        elif what == f"ready {alive[worker]}":
            give(worker, now)
        elif what == f"done {alive[worker]}":
            runs, since = at_hand.pop(worker)
            busy += now - since - costs.trip
            cost = costs.send + runs * costs.row
            free_at = max(free_at, now) + cost
            taken += cost
            done += runs
            give(worker, max(now, free_at - cost))
        refill(now)
    hours = max(now, free_at) / HOUR
    return Outcome(hours, busy / (case.workers * hours * HOUR), taken / (hours * HOUR), lost, loads)


def row(case: Case, costs: Costs) -> str:
    """What is to be known of *case*, as a line of a table in Markdown."""
    outcome = simulate(case, costs)
    hosts = -(-case.workers // case.per_host)
    traffic = case.runs * costs.travel_bytes + outcome.loads * costs.load_bytes
    peak = traffic / (outcome.hours * HOUR)
    stored = case.runs * costs.row_bytes
    cells = (
        case.name,
        f"{case.runs:,}",
        f"{case.seconds:g} s",
        f"{case.workers:,}",
        f"{outcome.hours:.3g} h",
        f"{outcome.busy:.0%}",
        f"{outcome.coordinator:.1%}",
        f"{outcome.loads / (outcome.hours * HOUR):.1f}/s",
        f"{outcome.lost_runs:,}",
        f"{peak / 1e3:.0f} kB/s + {hosts * costs.fmu_bytes / 1e6:.0f} MB",
        f"{stored / 1e9:.2f} GB",
        f"{case.runs * costs.waveform_bytes / 1e9:.0f} GB",
    )
    return f"| {' | '.join(cells)} |"


_TIMES = ("case", "runs", "a run", "workers", "takes", "workers busy", "coordinator", "batches", "lost runs")
_COLUMNS = (*_TIMES, "traffic + FMUs", "rows", "waveforms")

HEAD = f"| {' | '.join(_COLUMNS)} |\n|{'---|' * len(_COLUMNS)}"

PLAN = Case("planned", 1_000_000, 60.0, 1000)
CASES = (
    PLAN,
    replace(PLAN, name="preemptible, 1 h", lost_after=HOUR),
    replace(PLAN, name="slow and quick hosts", spread=0.8),
    replace(PLAN, name="short runs", seconds=0.02, arrive=30.0),
    replace(PLAN, name="a second", seconds=1.0, arrive=60.0),
    replace(PLAN, name="100 workers", workers=100),
)


def main() -> None:
    print(HEAD)
    for case in CASES:
        print(row(case, Costs()))


if __name__ == "__main__":
    main()
