"""A system in two halves that talk over datagrams is the same system, bit for bit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from linear_fmus import Linear, system
from live.halves import ORDERLY, Halves

from dse.cosim import Simulator
from dse.domain.method import Extrapolation, Method
from dse.domain.system import SystemStructure

NEAR, FAR = ("car", "driver"), ("road", "lead")
WIRES = [
    "car.y0 -> road.u0", "car.y1 -> road.u1", "road.y0 -> driver.u0", "driver.y0 -> car.u0",
    "road.y1 -> lead.u0", "lead.y0 -> driver.u1", "driver.y1 -> lead.u1", "car.y0 -> driver.u2",
]  # fmt: skip
RECORD = [f"{name}.y{i}" for name in (*NEAR, *FAR) for i in range(2)]


def swinging(n: int, **options: object) -> Linear:
    """Two states that turn about each other and are pushed by all inputs."""
    a = [[-0.3, 1.0 + n], [-1.7, -0.1 * n]]
    made = Linear(a, [[0.31, -0.2, 0.1], [0.7 / (n + 1), 0.3, -0.6]], [[1.0, 0.1], [0.3, 1.0 / 3]], (), [1.0, n / 7])
    return replace(made, **options)  # type: ignore[arg-type]


@pytest.fixture
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.getbasetemp()


def whole(folder: Path, version: int = 2, **options: object) -> SystemStructure:
    elements = {name: swinging(n, version=version, **options) for n, name in enumerate((*NEAR, *FAR))}
    factors = {"car.y1 -> road.u1": -0.1, "driver.y0 -> car.u0": 1 / 3, "road.y0 -> driver.u0": 0.7}
    return system(elements, WIRES, folder, factors)


@pytest.mark.parametrize(
    "method",
    [*ORDERLY, Method(extrapolation=Extrapolation.LINEAR, extrapolations={"outside": Extrapolation.HOLD})],
    ids=["jacobi", "gauss_seidel", "linear"],
)
@pytest.mark.parametrize("version", [2, 3])
def test_both_halves_record_what_the_whole_records(folder, cache, port, method: Method, version: int):
    made = whole(folder, version)
    with Simulator(made, RECORD, method=replace(method, extrapolations={})) as simulator:
        expected = simulator.run(stop=2.0, step=0.01)
    halves = Halves(made, NEAR, cache, port, version=version)
    near, far = halves.run(RECORD[:4], RECORD[4:], method, stop=2.0, step=0.01)
    assert near.tobytes() == expected[:, :4].tobytes()
    assert far.tobytes() == expected[:, 4:].tobytes()


def test_a_start_that_is_asked_for_again_with_other_values_gives_what_these_lead_to(folder, cache, port):
    # FMUs that do not tell what their outputs depend on: the values go round until they stay, each time a new session.
    made = whole(folder, tells=False)
    with Simulator(made, RECORD) as simulator:
        expected = simulator.run(stop=0.1, step=0.01)
    near, far = Halves(made, NEAR, cache, port).run(RECORD[:4], RECORD[4:], Method(), stop=0.1, step=0.01)
    assert near.tobytes() == expected[:, :4].tobytes()
    assert far.tobytes() == expected[:, 4:].tobytes()
