"""Other road users brake as the surface allows, by closed forms; without the input `surface` nothing changes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import pytest

NewPart = Callable[..., Any]
G, ICE = 9.81, 0.9
LIMIT = 0.9 * (1 - ICE) * G  # tyres with 0.9 on dry asphalt
WANTED, SPEED, BEGIN = 6.0, 20.0, 1.0

# A vehicle at 20 m/s that is to brake with 6 m/s2 from one second on, by its parameters.
BRAKING: dict[str, dict[str, Any]] = {
    "lead_vehicle": {
        "lead_speed": SPEED, "lead_change_time": BEGIN, "lead_change_rate": WANTED, "lead_final_speed": 0.0,
    },
    "vehicles": {
        "class[1]": 1, "speed[1]": SPEED, "change_time[1]": BEGIN, "change_rate[1]": WANTED, "final_speed[1]": 0.0,
    },
    "cut_in": {
        "initial_gap": 50.0, "speed": SPEED, "begin": 0, "begin_time": BEGIN, "change_rate": WANTED, "final_speed": 0.0,
    },
}  # fmt: skip


def made(new_part: NewPart, name: str, loss: float | None, **values: Any) -> Any:
    part = new_part(name)
    for key, value in values.items():
        part[key] = value
    if loss is not None:
        part["surface.friction_loss"] = loss
    part.init()
    return part


@pytest.mark.parametrize("name", BRAKING)
@pytest.mark.parametrize(("loss", "rate"), [(ICE, LIMIT), (0.0, WANTED), (None, WANTED), (math.nan, WANTED)])
def test_a_vehicle_that_is_to_brake_hard_brakes_as_the_friction_allows(
    new_part: NewPart, name: str, loss: float | None, rate: float
) -> None:
    part = made(new_part, name, loss, **BRAKING[name])
    start = part["movers[1].station"]
    hardest = 0.0
    for _ in range(300):
        part.step()
        hardest = max(hardest, -part["movers[1].acceleration"])
    assert hardest == pytest.approx(rate, rel=1e-12)
    assert loss != ICE or hardest <= 0.1 * G
    assert part["movers[1].station"] - start == pytest.approx(SPEED * 3 - 0.5 * rate * 2**2, rel=1e-9)


@pytest.mark.parametrize("name", BRAKING)
def test_a_surface_that_changes_while_a_vehicle_brakes_does_not_move_it(new_part: NewPart, name: str) -> None:
    part = made(new_part, name, 0.0, **BRAKING[name])
    steps = []
    for k in range(300):
        before = part["movers[1].station"]
        part["surface.friction_loss"] = 0.0 if k < 150 else ICE
        part.step()
        steps.append(part["movers[1].station"] - before)
    assert max(abs(b - a) for a, b in itertools.pairwise(steps)) < 1.01 * WANTED * 0.01**2


def behind(new_part: NewPart, name: str, gap: float, speed: float, loss: float) -> tuple[Any, list[float]]:
    """A vehicle that is *gap* behind a stationary one, and its accelerations in 80 s."""
    values = {"class[1]": 1, "class[2]": 1, "station[1]": 0.0, "station[2]": gap + 4.5, "speed[1]": speed}
    part = made(new_part, name, loss, **values, **{"desired_speed[1]": speed, "desired_speed[2]": 0.1})
    accelerations = []
    for _ in range(8000):
        part.step()
        accelerations.append(part["movers[1].acceleration"])
        if part["movers[1].speed"] == 0 or part["movers[1].station"] > gap + 4.5:
            break
    return part, accelerations


def test_traffic_stops_on_ice_behind_a_stationary_vehicle_that_it_sees_in_time(new_part: NewPart) -> None:
    for speed in (5.0, 15.0, 25.0):
        # It would need v^2 / (2 a) with all of the friction.
        part, accelerations = behind(new_part, "idm_traffic", 3 * speed**2 / (2 * LIMIT), speed, ICE)
        assert -min(accelerations) <= LIMIT + 1e-12
        assert part["movers[1].station"] < part["movers[2].station"] - 4.5


def test_traffic_that_sees_it_too_late_slides_with_the_friction_limit(new_part: NewPart) -> None:
    gap, speed = 30.0, 20.0
    part, accelerations = behind(new_part, "idm_traffic", gap, speed, ICE)
    assert accelerations[0] == pytest.approx(-LIMIT, rel=1e-12)
    assert max(accelerations) == min(accelerations)
    # At the place of the other one, 4.5 m after contact.
    assert part["movers[1].speed"] == pytest.approx(math.sqrt(speed**2 - 2 * LIMIT * (gap + 4.5)), abs=0.02)


def test_traffic_on_a_dry_road_is_that_without_the_input(new_part: NewPart) -> None:
    """Bit for bit, also of the many."""
    for name in ("idm_traffic", "stream_traffic"):
        dry, plain = (made(new_part, name, loss, minds_host=False) for loss in (0.0, None))
        if name == "stream_traffic":
            assert dry["everyone[5].class"] > 0
        for _ in range(200):
            dry.step()
            plain.step()
        assert dry.values() == plain.values()


def test_no_vehicle_of_a_stream_brakes_or_starts_beyond_the_friction(new_part: NewPart) -> None:
    part = made(new_part, "stream_traffic", ICE, minds_host=False, count=40, closed=True, seed=4)
    plain = made(new_part, "stream_traffic", None, minds_host=False, count=40, closed=True, seed=4)
    largest = [0.0, 0.0]
    for _ in range(1500):
        for k, each in enumerate((part, plain)):
            each.step()
            rates = [abs(each[f"everyone[{i}].acceleration"]) for i in range(1, 41)]
            largest[k] = max(largest[k], *rates)
    assert largest[0] <= LIMIT + 1e-12
    assert largest[1] > 1.2 * LIMIT


def test_who_gives_way_on_ice_brakes_earlier_and_within_the_friction(new_part: NewPart) -> None:
    where = {"path": 1, "station": 0.0, "speed": 10.0, "manners": 1, "acceleration": 3.0, "deceleration": 2.5}
    conflict = {"path": 1, "other_path": 0, "entry": 150.0, "exit": 160.0, "other_entry": 400.0, "other_exit": 430.0}
    for loss, rate in ((ICE, LIMIT), (0.0, 3.0)):
        part = new_part("crossing_vehicle", **where)
        for name, value in conflict.items():
            part[f"conflicts[1].{name}"] = value
        part["conflicts[1].gives_way"], part["motion.speed"] = True, 1.0
        part["surface.friction_loss"] = loss
        part["lane.station"] = 370.0
        part.init()
        rates = []
        for k in range(7000):
            part["lane.station"] = min(370.0 + 0.01 * k, 412.0)
            part.step()
            rates.append(part["movers[1].acceleration"])
        assert max(rates) == pytest.approx(rate, rel=1e-9)
        assert -min(rates) <= (LIMIT if loss else 5.0)
        assert -min(rates) > (0.4 * LIMIT if loss else 2.0)
        # It waits a metre before the conflict.
        assert part["movers[1].speed"] == 0
        assert part["movers[1].station"] == pytest.approx(150 - 1 - 2.25, abs=0.2)
