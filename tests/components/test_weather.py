"""Weather by its numbers: published relations, and what sensors make of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st
from scipy.special import lambertw

NewPart = Callable[..., Any]
MM_PER_HOUR = 1e-3 / 3600
CLEAN = {"gap_noise": 0.0, "closing_speed_noise": 0.0, "latency": 0}
SENSORS = ["radar_77ghz_long", "radar_77ghz_mid", "lidar_905nm", "camera_mono"]


def test_the_default_weather_is_clear(new_part: NewPart) -> None:
    part, clear = new_part("set_weather"), new_part("clear")
    part.init()
    clear.init()
    for name in ("rain_rate", "snow_rate", "fog_extinction", "darkness"):
        assert part[f"visibility.{name}"] == clear[f"visibility.{name}"] == 0
    for name in ("friction_loss", "water_film"):
        assert part[f"surface.{name}"] == clear[f"surface.{name}"] == 0
    assert (part["air.wind_x"], clear["air.wind_x"], clear["air.density"]) == (0, 0, 1.2)
    # The standard atmosphere of ISO 2533 at sea level, 15 degC.
    assert part["air.density"] == pytest.approx(1.2250, abs=5e-5)
    assert part["surface.temperature"] == 288.15


def test_cold_air_is_denser_as_that_of_an_ideal_gas(new_part: NewPart) -> None:
    part = new_part("set_weather", temperature=253.15, pressure=95000.0)
    part.init()
    assert part["air.density"] == pytest.approx(95000 / 287.05287 / 253.15, rel=1e-15)


def test_a_water_film_grows_with_rain_as_the_road_research_laboratory_found(new_part: NewPart) -> None:
    part = new_part("set_weather", rain_rate=25 * MM_PER_HOUR, drainage_length=10.0, drainage_fall=0.02)
    part.init()
    # d = 0.046 (L R)^0.5 / S^0.2 in mm, with L in m and R in mm/h.
    assert part["surface.water_film"] == pytest.approx(1e-3 * 0.046 * math.sqrt(250) / 0.02**0.2, rel=1e-12)
    films = []
    for rate in (0, 1, 5, 20, 80):
        part["rain_rate"] = rate * MM_PER_HOUR
        part.step()
        films.append(part["surface.water_film"])
    assert films[0] == 0
    assert films == sorted(films)


def test_friction_falls_with_thin_films_and_with_snow_and_ice(new_part: NewPart) -> None:
    part = new_part("set_weather", standing_film=1e-4, critical_film=1e-4, wet_loss=0.3)
    part["road"] = "wet"
    part.init()
    assert part["surface.friction_loss"] == pytest.approx(0.75 * 0.3, rel=1e-12)  # by definition of the critical film
    part["standing_film"] = 5e-3
    part.step()
    assert part["surface.friction_loss"] == pytest.approx(0.3, rel=1e-12)
    part["road"] = "dry"
    part.step()
    assert part["surface.friction_loss"] == 0
    part["rain_rate"] = 10 * MM_PER_HOUR
    part.step()
    assert 0.29 < part["surface.friction_loss"] <= 0.3
    for road, loss in (("snow", 0.76), ("ice", 0.88)):
        part["road"] = road
        part.step()
        assert part["surface.friction_loss"] == loss


@pytest.mark.parametrize(("celsius", "net"), [(-5.0, 2.0), (0.0, 2.0), (4.0, 2.0 - 4 * 3 / 24), (20.0, 0.0)])
def test_falling_snow_lies_unless_it_melts_and_lowers_the_friction(
    new_part: NewPart, celsius: float, net: float
) -> None:
    """2 mm/h for half an hour; a degree-day factor of 3 mm, and three quarters of the loss at 0.5 mm."""
    part = new_part("set_weather", snow_rate=2 * MM_PER_HOUR, temperature=273.15 + celsius)
    part.init()
    assert part["surface.friction_loss"] == 0
    for hours in (0.25, 0.5):
        for _ in range(900):
            part.step(1.0)
        expected = 0.76 * (1 - 0.25 ** (net * hours / 0.5))
        assert part["surface.friction_loss"] == pytest.approx(expected, rel=1e-9)
    assert part["surface.water_film"] == 0


def test_lying_snow_melts_and_is_no_worse_than_ice_below_it(new_part: NewPart) -> None:
    part = new_part("set_weather", lying_snow=1e-3, temperature=283.15)
    part.init()
    assert part["surface.friction_loss"] == pytest.approx(0.76 * (1 - 0.25**2), rel=1e-12)
    part["road"] = "ice"
    part.step(0.0)
    assert part["surface.friction_loss"] == 0.88
    part["road"] = "dry"
    # 30 mm in a day: 1 mm takes 48 minutes.
    for minutes, left in ((24, 0.5e-3), (24, 0.0), (24, 0.0)):
        for _ in range(minutes):
            part.step(60.0)
        assert part["surface.friction_loss"] == pytest.approx(0.76 * (1 - 0.25 ** (left / 0.5e-3)), abs=1e-9)
    part["rain_rate"] = 10 * MM_PER_HOUR
    part.step(60.0)
    assert 0.28 < part["surface.friction_loss"] < 0.3


def test_fog_hides_all_but_a_twentieth_of_the_contrast_at_the_visibility(new_part: NewPart) -> None:
    part = new_part("set_weather", fog_visibility=80.0)
    part.init()
    assert math.exp(-part["visibility.fog_extinction"] * 80) == pytest.approx(0.05, rel=1e-12)


def test_a_gust_is_one_minus_cosine_on_top_of_the_wind_and_comes_again(new_part: NewPart) -> None:
    part = new_part("set_weather", wind_speed=5.0, wind_direction=2.0, gust_speed=12.0, gust_start=1.0,
                    gust_duration=2.0, gust_period=4.0)  # fmt: skip
    part.init()
    for k in range(1, 1201):
        part.step()
        t = k * 0.01 - 1
        since = t % 4 if t > 0 else -1
        gust = 6 * (1 - math.cos(math.pi * since)) if 0 < since < 2 else 0
        assert part["air.wind_x"] == pytest.approx((5 + gust) * math.cos(2), abs=1e-9)
        assert part["air.wind_y"] == pytest.approx((5 + gust) * math.sin(2), abs=1e-9)


def reach(part: Any, **visibility: float) -> float:
    """The range up to which the sensor sees, by halving."""
    for name in ("rain_rate", "snow_rate", "fog_extinction", "darkness"):
        part[f"visibility.{name}"] = visibility.get(name, 0.0)
    part["scene.hit"] = True
    low, high = 0.0, 2 * part["max_range"]
    while high - low > 1e-9:
        part["scene.range"] = (low + high) / 2
        part.step()
        low, high = (part["scene.range"], high) if part["target.detected"] else (low, part["scene.range"])
    return low


@pytest.mark.parametrize("name", ["radar_77ghz_long", "radar_77ghz_mid"])
def test_rain_shortens_a_radars_range_by_the_radar_equation(new_part: NewPart, name: str) -> None:
    part = new_part(name, **CLEAN)
    part.init()
    for rate in (5.0, 25.0, 100.0):
        loss = 1.132 * rate**0.718  # dB/km, ITU-R P.838-3 at 77 GHz, horizontal
        found = reach(part, rain_rate=rate * MM_PER_HOUR)
        # Power falls with R^4 and twice the loss: as much at max_range in clear air.
        assert 40 * math.log10(found) + 2 * loss * found / 1000 == pytest.approx(
            40 * math.log10(part["max_range"]), abs=1e-6
        )
    assert reach(part, fog_extinction=0.1, darkness=1.0, snow_rate=1e-6) == pytest.approx(part["max_range"], abs=1e-8)


def test_the_coefficients_of_rain_at_77_ghz_are_those_of_the_recommendation(new_part: NewPart) -> None:
    def curve(rows: list[tuple[float, float, float]], slope: float, constant: float) -> float:
        f = math.log10(77)
        return sum(a * math.exp(-(((f - b) / c) ** 2)) for a, b, c in rows) + slope * f + constant

    # ITU-R P.838-3, tables 1 and 3 (horizontal polarization).
    k = [(-5.33980, -0.10008, 1.13098), (-0.35351, 1.26970, 0.45400), (-0.23789, 0.86036, 0.15354),
         (-0.94158, 0.64552, 0.16817)]  # fmt: skip
    alpha = [(-0.14318, 1.82442, -0.55187), (0.29591, 0.77564, 0.19822), (0.32177, 0.63773, 0.13164),
             (-5.37610, -0.96230, 1.47828), (16.1721, -3.29980, 3.43990)]  # fmt: skip
    part = new_part("radar_77ghz_long")
    assert part["rain_loss"] == pytest.approx(10 ** curve(k, -0.18961, 0.71147), abs=5e-4)
    assert part["rain_exponent"] == pytest.approx(curve(alpha, 0.67849, -1.95537), abs=5e-4)


def test_fog_shortens_a_lidars_range_as_beer_and_lambert_have_it(new_part: NewPart) -> None:
    part = new_part("lidar_905nm", **CLEAN)
    part.init()
    for visibility in (500.0, 100.0, 30.0):
        a = -math.log(0.05) / visibility
        # R exp(a R) = max_range, solved by Lambert's function.
        expected = float(lambertw(a * part["max_range"]).real) / a
        assert reach(part, fog_extinction=a) == pytest.approx(expected, abs=1e-6)


def test_a_camera_sees_as_far_as_contrast_and_lamps_reach(new_part: NewPart) -> None:
    part = new_part("camera_mono", **CLEAN)
    part.init()
    for visibility in (300.0, 60.0, 25.0):
        fog = -math.log(0.05) / visibility  # with the least contrast 5 % it sees as far as Koschmieder's visibility
        assert reach(part, fog_extinction=fog) == pytest.approx(min(visibility, part["max_range"]), abs=1e-6)
    assert reach(part, darkness=1.0) == pytest.approx(60, abs=1e-8)
    assert reach(part, darkness=0.5) == pytest.approx(75, abs=1e-8)
    rain = 1.076 * 100**0.67 * math.log(10) / 10_000  # ITU-R P.1814, in 1/m
    assert reach(part, rain_rate=100 * MM_PER_HOUR) == pytest.approx(min(90, -math.log(0.05) / rain), abs=1e-6)


@pytest.mark.parametrize("name", SENSORS)
def test_more_of_any_weather_never_lengthens_the_range(new_part: NewPart, name: str) -> None:
    part = new_part(name, **CLEAN)
    part.init()
    rate, amount = st.floats(0, 5e-5), st.floats(0, 1)

    @settings(max_examples=30, deadline=None, derandomize=True)
    @given(rain=rate, snow=rate, fog=amount, dark=amount, more=st.floats(1, 3))
    def check(rain: float, snow: float, fog: float, dark: float, more: float) -> None:
        weather = {"rain_rate": rain, "snow_rate": snow, "fog_extinction": fog, "darkness": dark}
        first = reach(part, **weather)
        assert reach(part, **{key: value * more for key, value in weather.items()}) <= first + 1e-8
        assert first <= part["max_range"] + 1e-8

    check()
