"""Signs of many countries limit the speed, and those that cannot be read are told."""

from __future__ import annotations

from pathlib import Path

import pytest
from opendrive_texts import geometry, network, road

from dse.world import road_tables

KMH, MPH = 1 / 3.6, 0.44704


def sign(s: float, type_: str, **more: str) -> str:
    attributes = {"id": f"{s:g}", "s": f"{s!r}", "t": "-4", "orientation": "+", "dynamic": "no", "type": type_, **more}
    return "<signal " + " ".join(f'{name}="{value}"' for name, value in attributes.items()) + "/>"


def limits(folder: Path, *signs: str) -> tuple[list[float], list[str]]:
    """The speed limits along a road in m/s, and what is told of its signs."""
    read = network(
        folder, road("1", geometry(0.0, 0.0, 0.0, 0.0, 400.0), 400.0, more=f"<signals>{''.join(signs)}</signals>")
    )
    (path,) = road_tables(read).paths
    told = [problem.what for problem in read.roads["1"].ignored]
    return path.speed_limit.coefficients[:, 0].tolist(), told


@pytest.mark.parametrize(
    ("country", "type_", "more", "speed"),
    [
        ("DE", "274", {"value": "60", "unit": "km/h"}, 60 * KMH),
        ("deu", "274", {"subtype": "50"}, 50 * KMH),
        ("DE", "274-80", {}, 80 * KMH),
        ("DE", "274.1", {"value": "30"}, 30 * KMH),
        ("DE", "274", {"subtype": "-1", "value": "30", "unit": "mph"}, 30 * MPH),
        ("OpenDRIVE", "274", {"value": "70"}, 70 * KMH),
        ("US", "R2-1", {"value": "35", "unit": "mph"}, 35 * MPH),
        ("usa", "R2-1", {"value": "35"}, 35 * MPH),
        ("GB", "670", {"value": "40"}, 40 * MPH),
        ("UK", "670", {"value": "20", "unit": "mph"}, 20 * MPH),
        ("SE", "C31", {"value": "70"}, 70 * KMH),
        ("se", "C31-5", {}, 50 * KMH),
        ("se", "c", {"subtype": "31-11"}, 110 * KMH),
        ("AT", "52/10a", {"value": "100"}, 100 * KMH),
        ("CH", "2.30", {"value": "80"}, 80 * KMH),
        ("FR", "B14", {"value": "90"}, 90 * KMH),
        ("ES", "R-301", {"value": "120"}, 120 * KMH),
        ("CA", "Rb-1", {"value": "50"}, 50 * KMH),
    ],
)
def test_a_sign_limits_the_speed_by_its_country(
    country: str, type_: str, more: dict[str, str], speed: float, tmp_path: Path
) -> None:
    found, told = limits(tmp_path, sign(100.0, type_, country=country, **more))
    assert (found, told) == ([0.0, pytest.approx(speed)], [])


def test_signs_of_two_countries_follow_each_other_and_an_end_ends_the_limit(tmp_path: Path) -> None:
    signs = (
        sign(50.0, "274", country="DE", value="60"),
        sign(100.0, "R2-1", country="US", value="35"),
        sign(150.0, "C32", country="SE"),
        sign(200.0, "B14", country="FR", value="80"),
        sign(250.0, "671", country="GB"),
    )
    found, told = limits(tmp_path, *signs)
    assert (found, told) == (
        [0.0, *(pytest.approx(v) for v in (60 * KMH, 35 * MPH)), 0.0, pytest.approx(80 * KMH), 0.0],
        [],
    )


@pytest.mark.parametrize(
    ("country", "type_", "more", "what"),
    [
        ("XX", "R2-1", {}, "the sign 'R2-1' of XX may limit the speed, but the signs of its country are not known"),
        ("JP", "323", {"value": "40", "unit": "km/h"}, "the sign '323' of JP has the unit of a speed, and is no known"),
        ("DE", "275", {"value": "40", "unit": "km/h"}, "the sign '275' of DE has the unit of a speed, and is no known"),
        ("US", "R2-1", {"value": "-1"}, "the speed sign 'R2-1' of US has no value"),
    ],
)
def test_a_sign_that_cannot_be_read_is_told(
    country: str, type_: str, more: dict[str, str], what: str, tmp_path: Path
) -> None:
    found, (told,) = limits(tmp_path, sign(100.0, type_, country=country, **more))
    assert found == [0.0]
    assert told.startswith(what)


def test_other_signs_are_no_business_of_the_speed(tmp_path: Path) -> None:
    signs = sign(50.0, "306", country="DE"), sign(60.0, "R1-1", country="US"), sign(70.0, "1000001", dynamic="yes")
    assert limits(tmp_path, *signs) == ([0.0], [])
