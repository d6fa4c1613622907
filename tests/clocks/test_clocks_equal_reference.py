"""Systems of FMUs with clocks: the same bits as a master of its own on FMPy."""

from __future__ import annotations

import pytest

from clocks.fmus import Workshop, system_of
from clocks.master import ClockMaster
from dse.cosim.simulator import Simulator
from dse.domain.method import Algorithm, Coupling, Extrapolation, Method

TIMINGS = {
    "constant": 'intervalVariability="constant" intervalDecimal="0.3" shiftDecimal="0.1"',
    "constant in parts": 'intervalVariability="constant" intervalCounter="1" resolution="3" supportsFraction="true"',
    "constant on the grid": 'intervalVariability="constant" intervalDecimal="0.25"',
    "fixed": 'intervalVariability="fixed"',
    "fixed in parts": 'intervalVariability="fixed" supportsFraction="true"',
    "fixed and told": 'intervalVariability="fixed" intervalDecimal="0.07"',
    "tunable": 'intervalVariability="tunable"',
    "changing": 'intervalVariability="changing"',
    "countdown": 'intervalVariability="countdown"',
    "countdown in parts": 'intervalVariability="countdown" supportsFraction="true"',
}
KINDS = ["constant", "fixed", "tunable", "changing", "countdown"]
ALONE = ["a.count", "a.at", "a.sum", "a.seen", "a.rings", "a.heard", "a.y"]
AFTER_RING, ALONE_MODE, SPEEDS_UP, AGAIN = 1, 5, 6, 7
VECU = ("sent", "received", "last_id", "last_payload", "confirmed", "lost", "received_at", "malformed")


def parts_of(timing: str) -> float:
    return 1000.0 if "supportsFraction" in TIMINGS[timing] else 1.0


def start_of(name: str, timing: str, period: float, **more: float) -> dict[str, float]:
    parts = parts_of(timing)
    kind = KINDS.index(timing.split(maxsplit=1)[0])
    told = {"kind": kind, "period": round(period * parts, 9), "shift": 0.05 * parts, "parts": parts} | more
    return {f"{name}.{key}": float(value) for key, value in told.items()}


def same_bits(workshop, fmus, wires, start, record, *, stop=1.0, step=0.25, early="", method=None):
    models = {name: workshop.open(path) for name, path in fmus.items()}
    system = system_of(models, wires, start, record)
    with Simulator(system, record, method=method or Method()) as simulator:
        fast = [simulator.run(stop=stop, step=step) for _ in range(3)]
    with ClockMaster(fmus, wires, start, early) as master:
        slow = master.run(record, stop, step)
    for rows in fast:
        assert rows.tolist() == slow.tolist()
    return slow


@pytest.mark.parametrize("timing", TIMINGS)
def test_a_clock_that_ticks_by_itself_ticks_when_its_fmu_says(workshop: Workshop, timing):
    start = start_of("a", timing, 0.15, every=2.0) | {"a.u": 2.0, "a.x": 3.0}
    rows = same_bits(workshop, {"a": workshop.ticker(TIMINGS[timing])}, [], start, ALONE, early="a")
    assert rows[-1, 0] >= 3  # and not by chance the same because nothing happens


@pytest.mark.parametrize("timing", ["constant", "changing", "countdown in parts"])
@pytest.mark.parametrize("step", [0.25, 0.1, 1.0])
def test_what_ticks_with_another_takes_what_the_other_gives(workshop: Workshop, timing, step):
    fmus = {"a": workshop.ticker(TIMINGS[timing]), "b": workshop.ticker(TIMINGS["countdown"])}
    wires = ["a.bell -> b.ring", "a.sum -> b.v", "b.heard -> a.x", "b.y -> a.u"]
    start = start_of("a", timing, 0.15, every=2.0) | start_of("b", "countdown", 0.0, mode=AFTER_RING, delay=0.04)
    record = [*ALONE, *(label.replace("a.", "b.") for label in ALONE)]
    rows = same_bits(workshop, fmus, wires, start, record, step=step, early="a")
    assert rows[-1, record.index("b.rings")] >= 1
    assert rows[-1, record.index("b.count")] >= 1


def test_clocks_of_two_fmus_that_are_due_together_tick_in_one_instant(workshop: Workshop):
    timing = TIMINGS["constant"]
    fmus = {"a": workshop.ticker(timing), "b": workshop.ticker(timing)}
    # a.sum depends on a.u, b.count on nothing: in each instant a adds what b has counted in it, not before.
    rows = same_bits(workshop, fmus, ["b.count -> a.u"], {}, ["a.sum", "b.count"])
    assert rows[-1].tolist() == [1 + 2 + 3 + 4, 4]
    rows = same_bits(workshop, {"b": fmus["a"], "a": fmus["b"]}, ["b.count -> a.u"], {}, ["a.sum", "b.count"])
    assert rows[-1].tolist() == [1 + 2 + 3 + 4, 4]


def test_an_fmu_that_tells_others_may_stop_where_it_has_to(workshop: Workshop):
    # Three bells at 0.2, 0.4, 0.6, 0.8 s between communication points that are 0.5 s apart.
    fmus = {"b": workshop.ticker(), "a": workshop.ticker()}
    start = {"a.mode": ALONE_MODE, "a.delay": 0.2, "b.mode": AFTER_RING, "b.delay": 0.05, "b.kind": 4.0}
    start |= {"a.period": 9.0, "a.kind": 4.0}
    record = ["b.rings", "b.count", "b.at", "a.y"]
    rows = same_bits(workshop, fmus, ["a.bell -> b.ring"], start, record, step=0.5, early="a")
    assert rows[:, 0].tolist() == [0, 2, 5]
    assert rows[1:, 2] == pytest.approx([0.45, 0.85])


def test_an_event_at_the_end_of_a_step_is_no_early_return(workshop: Workshop):
    fmus = {"b": workshop.ticker(mightReturnEarlyFromDoStep="false"), "a": workshop.ticker()}
    start = {"a.mode": ALONE_MODE, "a.delay": 0.2, "a.hasty": 1.0, "a.period": 9.0, "a.kind": 4.0, "b.period": 9.0}
    # Two that tell each other: none may stop before the other.
    wires = ["a.bell -> b.ring", "b.bell -> a.ring"]
    rows = same_bits(workshop, fmus, wires, start, ["b.rings", "a.y"], step=0.5)
    assert rows[:, 0].tolist() == [0, 1, 2]


def test_intervals_that_change_and_updates_that_are_repeated(workshop: Workshop):
    for mode in (SPEEDS_UP, AGAIN):
        start = start_of("a", "tunable", 0.1, mode=mode) | {"a.u": 1.0}
        rows = same_bits(workshop, {"a": workshop.ticker(TIMINGS["tunable"])}, [], start, ALONE, early="a")
        # From 0.05 s every 0.1 s; the second tick makes it 0.05 s.
        assert rows[-1, 0] == (19 if mode == SPEEDS_UP else 10)


@pytest.mark.parametrize(
    "method",
    [
        Method(algorithm=Algorithm.GAUSS_SEIDEL),
        Method(coupling=Coupling.PROPAGATE),
        Method(extrapolation=Extrapolation.LINEAR),
    ],
    ids=["gauss-seidel", "propagate", "linear"],
)
def test_every_algorithm_lets_clocks_tick(workshop: Workshop, method):
    start = start_of("a", "constant", 0.0) | {"a.u": 2.0, "a.x": 3.0}
    fmus = {"a": workshop.ticker(TIMINGS["constant"])}
    same_bits(workshop, fmus, [], start, ALONE, early="a", method=method)


DIRECT = ["a.Tx_Data -> b.Rx_Data", "b.Tx_Data -> a.Rx_Data"]
BUS = [
    *(f"{n}.Tx_Data -> bus.Node{k}.Rx_Data" for k, n in ((1, "a"), (2, "b"))),
    *(f"bus.Node{k}.Tx_Data -> {n}.Rx_Data" for k, n in ((1, "a"), (2, "b"))),
]
CAN = {"a.id": 1.0, "a.period": 0.3, "a.offset": 0.3, "b.id": 2.0, "b.period": 0.2, "b.offset": 0.1, "b.burst": 2.0}


@pytest.mark.parametrize("timed", [False, True], ids=["triggered", "countdown"])
@pytest.mark.parametrize("step", [0.25, 0.1])
def test_two_virtual_ecus_exchange_can_frames(workshop: Workshop, timed, step):
    fmus = dict.fromkeys("ab", workshop.vecu(timed=timed))
    record = [f"{n}.{v}" for n in "ab" for v in VECU]
    wires = DIRECT if timed else [*DIRECT, "a.Tx_Clock -> b.Rx_Clock", "b.Tx_Clock -> a.Rx_Clock"]
    end = dict(zip(record, same_bits(workshop, fmus, wires, CAN, record, step=step)[-1], strict=True))
    assert (end["a.sent"], end["b.sent"]) == (3, 10)
    assert (end["a.received"], end["a.last_id"], end["a.last_payload"]) == (10, 2, 9)
    assert (end["b.received"], end["b.last_id"], end["b.last_payload"]) == (3, 1, 2)
    assert end["b.received_at"] == pytest.approx(0.9 if timed else {0.25: 1.0, 0.1: 0.9}[step])
    assert end["a.malformed"] == end["b.malformed"] == 0


@pytest.mark.parametrize("timed", [False, True], ids=["triggered", "countdown"])
@pytest.mark.parametrize("discards", [0.0, 1.0], ids=["waits", "is told"])
def test_a_bus_between_them_takes_its_time_and_decides_who_goes_first(workshop: Workshop, timed, discards):
    fmus = {**dict.fromkeys("ab", workshop.vecu(timed=timed)), "bus": workshop.bus()}
    record = [f"{n}.{v}" for n in "ab" for v in VECU]
    both = CAN | {"b.period": 0.3, "b.offset": 0.3, "b.burst": 1.0, "b.discards": discards}
    end = dict(zip(record, same_bits(workshop, fmus, BUS, both, record, step=0.1)[-1], strict=True))
    # Both send at 0.3, 0.6 and 0.9 s; 48 bits at 100 kBit/s, the lower id first.
    assert (end["a.confirmed"], end["b.received"]) == (3, 3)
    assert end["b.received_at"] == pytest.approx(0.90048)
    assert (end["b.confirmed"], end["a.received"], end["b.lost"]) == ((0, 0, 3) if discards else (3, 3, 0))
    assert end["a.received_at"] == pytest.approx(0.0 if discards else 0.90096)
    assert end["a.malformed"] == end["b.malformed"] == 0
