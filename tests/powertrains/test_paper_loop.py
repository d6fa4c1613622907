"""The loop of the paper in FMUs, Modelica powertrain and C controller, against one run of the whole in scipy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from combustion import CAR, CombustionCar
from combustion_gears import SIX_SPEED
from hybrid_system import integrate

from dse.cosim.simulator import Simulator
from dse.domain.component import Causality, Component, Interface, Kind, ModelicaSource, Port, Type
from dse.domain.design import Connection
from dse.fmu.component_build import build_all
from dse.fmu.unpack import open_fmu
from dse.loading.workspace import Workspace
from dse.system.assembly import WiredParts, assemble
from dse.units import parse_unit

HERE = Path(__file__).parent
COMPONENTS = HERE.parent.parent / "components"
STEP, STEPS = 0.01, 4_000
SET_SPEED, SET_GAP, LEAD_SPEED, INITIAL_GAP, SIGHT = 70 / 3.6, 40.0, 50 / 3.6, 150.0, 160.0


def following() -> Component:
    """The car and the vehicle in front, integrated to 1e-9."""

    def port(name: str, causality: Causality, kind: Kind, unit: str) -> Port:
        return Port(name, causality, Type(kind, parse_unit(unit)))

    ports = (
        port("demand", Causality.INPUT, Kind.REAL, "N.m"),
        port("brake", Causality.INPUT, Kind.REAL, "N.m"),
        port("speed", Causality.OUTPUT, Kind.REAL, "m/s"),
        port("gap", Causality.OUTPUT, Kind.REAL, "m"),
        port("closing_speed", Causality.OUTPUT, Kind.REAL, "m/s"),
        port("detected", Causality.OUTPUT, Kind.BOOLEAN, "1"),
    )
    files = (HERE / "Loop.mo", HERE / "Combustion.mo", COMPONENTS / "AdasPowertrain")
    source = ModelicaSource("Loop.Following", files, tolerance=1e-9)
    return Component("following", Interface("car", ports), source=source)


CONNECTIONS = (
    "car.speed -> controller.speed",
    "car.gap -> controller.target.gap",
    "car.closing_speed -> controller.target.closing_speed",
    "car.detected -> controller.target.detected",
    "controller.demand.drive_torque -> car.demand",
    "controller.demand.brake_torque -> car.brake",
)


def loop_of_fmus(cache: Path) -> np.ndarray:
    """Speed and gap every 10 ms, by our master."""
    parts = {"car": following(), "controller": Workspace.around(COMPONENTS).component("pd_acc")}
    archives = build_all(parts.values(), cache=cache)
    models = {name: open_fmu(archive, cache=cache) for name, archive in archives.items()}
    connections = tuple(Connection(*text.split(" -> ")) for text in CONNECTIONS)
    values = {"controller.set_speed": SET_SPEED, "controller.set_gap": SET_GAP}
    record = ["car.speed", "car.gap"]
    system = assemble("loop", WiredParts(parts, connections, values), models, record)
    with Simulator(system, record) as simulator:
        return simulator.run(stop=STEP * STEPS, step=STEP)


class Controller:
    """components/controllers/pd_acc with its nominal parameters, written once more."""

    def __init__(self, parameters: dict[str, float], speed: float) -> None:
        self.of = parameters
        self.previous_error = SET_SPEED - speed

    def demand(self, speed: float, gap: float) -> tuple[float, float]:
        """Torques of drive and brake, N.m."""
        of, error = self.of, SET_SPEED - speed
        slope = (error - self.previous_error) / STEP
        self.previous_error = error
        wanted = self._limited(of["kp_speed"] * error + of["kd_speed"] * slope)
        if gap < SIGHT:
            chase = of["kp_gap"] * (gap - SET_GAP) - of["kd_gap"] * (speed - LEAD_SPEED)
            wanted = min(wanted, self._limited(chase))
        drag = 0.5 * 1.2 * of["drag_area"] * speed * abs(speed)
        rolling = of["rolling_resistance"] * of["nominal_mass"] * 9.81 if speed > 0 else 0.0
        torque = of["wheel_radius"] * (of["nominal_mass"] * wanted + drag + rolling)
        return max(torque, 0.0), max(-torque, 0.0)

    def _limited(self, acceleration: float) -> float:
        return min(max(acceleration, -self.of["max_deceleration"]), self.of["max_acceleration"])


def monolith() -> np.ndarray:
    """The same in one program: the physics by DOP853 at 1e-11, the controller every 10 ms with a step of delay."""
    parameters = {
        parameter.name: parameter.start for parameter in Workspace.around(COMPONENTS).component("pd_acc").parameters
    }
    car = CombustionCar(demand=lambda time: torques[0], gears=SIX_SPEED, has_converter=True)
    car.brake = lambda time: torques[1]
    y = np.append(car.start(), 0.0)
    controller = Controller(parameters, y[CAR])
    torques = controller.demand(y[CAR], INITIAL_GAP)  # at the initialization
    moving = _WithPosition(car)
    rows = []
    for k in range(STEPS + 1):
        gap = INITIAL_GAP + LEAD_SPEED * k * STEP - y[-1]
        rows.append((y[CAR], gap))
        following_torques = controller.demand(y[CAR], gap)
        y = integrate(moving, y, np.array([k, k + 1]) * STEP, 1e-11, STEP).states[-1]
        torques = following_torques
    return np.array(rows)


class _WithPosition:
    """The car with the way it has gone as its last state."""

    def __init__(self, car: CombustionCar) -> None:
        self.car = car
        self.events = car.events

    def derivative(self, time: float, state: np.ndarray) -> list[float]:
        return [*self.car.derivative(time, state[:-1]), state[CAR]]


@pytest.mark.thorough
def test_the_loop_with_a_modelica_powertrain_and_a_c_controller_is_that_of_one_program(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    found = loop_of_fmus(tmp_path_factory.mktemp("loop"))
    expected = monolith()
    error = np.abs(found - expected).max(axis=0)
    # Both integrate the same equations, to 1e-9 and 1e-11; the controller sees the same sampled values.
    assert error[0] < 1e-6
    assert error[1] < 1e-5
    speed, gap = found.T
    assert speed.max() > 0.99 * SET_SPEED  # it did accelerate, shift, and close in
    assert gap[-1] < 60
