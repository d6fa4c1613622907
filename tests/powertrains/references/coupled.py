"""Parts as FMUs of their own, exchanging signals at fixed steps; the car between them is a few lines of Python."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from bench import Bench, opened
from electric import Car
from numpy.typing import NDArray

Wires = Sequence[tuple[str, str, str, str]]
"""Source part, its output, target part, its input. The part ``car`` has speed, wheel_speed, torque_demand."""

RANGE_EXTENDER: Wires = (
    ("car", "torque_demand", "control", "torque_demand"),
    ("axle", "machine_speed", "control", "motor_speed"),
    ("battery", "soc", "control", "soc"),
    ("control", "machine_torque_demand", "machine", "torque_demand"),
    ("axle", "machine_speed", "machine", "shaft_speed"),
    ("battery", "voltage", "machine", "voltage"),
    ("control", "generator_power_demand", "generator", "power_demand"),
    ("machine", "electric_power", "battery", "electric_power"),
    ("generator", "electric_power", "battery", "charging_power"),
    ("machine", "torque", "axle", "machine_torque"),
    ("car", "wheel_speed", "axle", "wheel_speed_front"),
    ("car", "wheel_speed", "axle", "wheel_speed_rear"),
)
HYBRID: Wires = (
    ("car", "torque_demand", "control", "torque_demand"),
    ("gearbox", "ratio", "control", "ratio"),
    ("gearbox", "engine_speed", "control", "engine_speed"),
    ("gearbox", "machine_speed", "control", "machine_speed"),
    ("battery", "soc", "control", "soc"),
    ("battery", "discharge_power", "control", "discharge_power"),
    ("battery", "charge_power", "control", "charge_power"),
    ("machine", "torque_limit", "control", "machine_torque_limit"),
    ("control", "engine_torque_demand", "engine", "torque_demand"),
    ("gearbox", "engine_speed", "engine", "shaft_speed"),
    ("control", "machine_torque_demand", "machine", "torque_demand"),
    ("gearbox", "machine_speed", "machine", "shaft_speed"),
    ("battery", "voltage", "machine", "voltage"),
    ("machine", "electric_power", "battery", "electric_power"),
    ("engine", "torque", "gearbox", "engine_torque"),
    ("machine", "torque", "gearbox", "machine_torque"),
    ("control", "clutch", "gearbox", "clutch"),
    ("car", "wheel_speed", "gearbox", "wheel_speed_front"),
    ("car", "wheel_speed", "gearbox", "wheel_speed_rear"),
)


def drive(
    models: Mapping[str, str],
    starts: Mapping[str, Mapping[str, float]],
    wires: Wires,
    car: Car,
    demand: Callable[[float], float],
    watched: Sequence[tuple[str, str]],
    stop: float,
    cache: Path,
    step: float = 0.01,
    tolerance: float = 1e-6,
    wheel_inertia: float = 0.0,
) -> NDArray[np.float64]:
    """Rows of time, speed of the car and what is *watched*, each *step* seconds; all parts step at once (Jacobi).

    With *wheel_inertia* the wheels hang on nothing: they turn freely instead of moving the car.
    """
    parts = {name: Bench(opened(model, cache), tolerance, starts.get(name)) for name, model in models.items()}
    speed, rows = 0.0, []
    mass = wheel_inertia / car.wheel_radius**2 if wheel_inertia else car.mass
    last = "gearbox" if "gearbox" in parts else "axle"
    for k in range(round(stop / step)):
        now = k * step
        known = {"speed": speed, "wheel_speed": speed / car.wheel_radius, "torque_demand": demand(now)}
        signals = {
            (source, output): known[output] if source == "car" else parts[source].get([output])[0]
            for source, output in {(wire[0], wire[1]) for wire in wires}
        }
        torque = sum(parts[last].get(["torque_front", "torque_rear"]))
        rows.append([now, speed, *(parts[part].get([name])[0] for part, name in watched)])
        for name, part in parts.items():
            part.set({wire[3]: signals[wire[0], wire[1]] for wire in wires if wire[2] == name})
        for part in parts.values():
            part.step(now, step)
        force = torque / car.wheel_radius - (0.0 if wheel_inertia else car.resistance(speed))
        # The car's own step: Heun with the torque held.
        guess = speed + step * force / mass
        later = torque / car.wheel_radius - (0.0 if wheel_inertia else car.resistance(guess))
        speed += 0.5 * step * (force + later) / mass
    for part in parts.values():
        assert not part.messages
        part.close()
    found = np.array(rows)
    assert math.isfinite(float(np.abs(found).max()))
    return found
