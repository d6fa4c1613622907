"""Range sensors: what they see, when they say it, and how well."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

NewPart = Callable[..., Any]
SENSORS = ["radar_77ghz_long", "radar_77ghz_mid", "lidar_905nm", "camera_mono"]
CLEAN = {"gap_noise": 0.0, "closing_speed_noise": 0.0, "latency": 0}


def look(part: Any, distance: float, closing_speed: float = 0.0, azimuth: float = 0.0, hit: bool = True) -> None:
    part["scene.range"] = distance
    part["scene.closing_speed"] = closing_speed
    part["scene.azimuth"] = azimuth
    part["scene.hit"] = hit
    part.step()


@pytest.mark.parametrize("name", SENSORS)
def test_a_target_is_seen_up_to_the_sensors_range_and_no_further(new_part: NewPart, name: str) -> None:
    part = new_part(name, **CLEAN)
    part.init()
    reach = part["max_range"]
    assert float(part.component.properties["range"].si) == reach
    look(part, reach, 3.0)
    assert part["target.detected"]
    assert (part["target.gap"], part["target.closing_speed"]) == (reach, 3.0)
    look(part, math.nextafter(reach, math.inf))
    assert not part["target.detected"]


@pytest.mark.parametrize("name", SENSORS)
@pytest.mark.parametrize("side", [-1, 1])
def test_a_target_is_seen_within_the_field_of_view_only(new_part: NewPart, name: str, side: int) -> None:
    part = new_part(name, **CLEAN)
    part.init()
    half = part["field_of_view"] / 2
    assert float(part.component.properties["field_of_view"].si) == pytest.approx(2 * half)
    look(part, 30.0, azimuth=side * 0.999 * half)
    assert part["target.detected"]
    look(part, 30.0, azimuth=side * 1.001 * half)
    assert not part["target.detected"]


def test_range_and_doppler_along_the_ray_become_gap_and_speed_along_the_road(new_part: NewPart) -> None:
    part = new_part("radar_77ghz_mid", **CLEAN)
    part.init()
    look(part, 50.0 / math.cos(0.2), 4.0 * math.cos(0.2), azimuth=0.2)
    assert part["target.gap"] == pytest.approx(50.0, rel=1e-14)
    assert part["target.closing_speed"] == pytest.approx(4.0, rel=1e-14)


def test_a_lost_target_keeps_its_last_gap_and_says_it_is_not_detected(new_part: NewPart) -> None:
    part = new_part("radar_77ghz_mid", **CLEAN)
    part.init()
    look(part, 60.0, 2.0)
    for _ in range(20):
        look(part, 300.0, 0.0, hit=False)
    assert not part["target.detected"]
    assert (part["target.gap"], part["target.closing_speed"]) == (60.0, 2.0)


@pytest.mark.parametrize("latency", [0, 1, 4, 15])
def test_a_sample_is_reported_as_many_samples_late_as_set(new_part: NewPart, latency: int) -> None:
    part = new_part("radar_77ghz_mid", **{**CLEAN, "latency": latency})
    part["scene.range"], part["scene.hit"] = 10.0, True
    part.init()
    assert part["target.gap"] == 10.0
    for k in range(1, 60):
        look(part, 10.0 + k)
        assert part["target.gap"] == 10.0 + max(k - latency, 0)


def measure(part: Any, samples: int) -> NDArray[np.float64]:
    rows = []
    part["latency"] = 0
    part.init()
    for _ in range(samples):
        look(part, 50.0, 4.0)
        rows.append((part["target.gap"] - 50.0, part["target.closing_speed"] - 4.0))
    return np.array(rows)


def test_noise_has_the_standard_deviation_asked_for_and_no_bias(new_part: NewPart) -> None:
    n = 20_000
    noise = measure(new_part("radar_77ghz_mid", gap_noise=0.3, closing_speed_noise=0.08, seed=7), n)
    for column, sigma in zip(noise.T, (0.3, 0.08), strict=True):
        # Three standard errors of the mean, of the standard deviation, and of a correlation.
        assert abs(column.mean()) < 3 * sigma / math.sqrt(n)
        assert abs(column.std(ddof=1) - sigma) < 3 * sigma / math.sqrt(2 * n)
        assert abs(np.corrcoef(column[1:], column[:-1])[0, 1]) < 3 / math.sqrt(n)
        # The fourth moment of a normal variable is 3 with variance 96.
        assert abs(np.mean((column / sigma) ** 4) - 3) < 3 * math.sqrt(96 / n)
    assert abs(np.corrcoef(noise[:, 0], noise[:, 1])[0, 1]) < 3 / math.sqrt(n)


def test_the_same_seed_gives_the_same_bits_and_another_seed_others(new_part: NewPart) -> None:
    first, again, other = (measure(new_part("camera_mono", seed=seed), 50) for seed in (3, 3, 4))
    assert first.tobytes() == again.tobytes()
    assert not np.any(first[:, 0] == other[:, 0])


def test_without_noise_the_measurement_is_exact_even_if_the_other_signal_is_noisy(new_part: NewPart) -> None:
    noise = measure(new_part("radar_77ghz_mid", gap_noise=0.0, closing_speed_noise=0.1), 50)
    assert not noise[:, 0].any()
    assert noise[:, 1].all()


def test_noise_does_not_depend_on_what_was_seen_before(new_part: NewPart) -> None:
    def last(seen: bool) -> float:
        part = new_part("radar_77ghz_mid", gap_noise=0.2, latency=0)
        part.init()
        for _ in range(9):
            look(part, 50.0, hit=seen)
        look(part, 50.0)
        return float(part["target.gap"])

    assert last(seen=True) == last(seen=False)
