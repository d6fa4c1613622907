"""Slippery patches that repeat along a road."""

from __future__ import annotations

from pathlib import Path

import pytest
from opendrive_texts import geometry, network, road

from dse.errors import DseError
from dse.world import road_tables


def patches(folder: Path, repeat: str, **attributes: str) -> list[tuple[float, ...]]:
    """From, to, right and left of the patches of an object of 2 m by 1 m at 20 m."""
    given = {"id": "1", "s": "20", "t": "-1.5", "hdg": "0", "length": "2", "width": "1", **attributes}
    text = " ".join(f'{name}="{value}"' for name, value in given.items())
    object_ = f'<objects><object {text}><repeat {repeat}/><material friction="0.1"/></object></objects>'
    read = network(folder, road("1", geometry(0.0, 0.0, 0.0, 0.0, 200.0), 200.0, more=object_))
    (path,) = road_tables(read).paths
    assert {patch.friction for patch in path.patches} == {0.1}
    return [(patch.start, patch.end, patch.right, patch.left) for patch in path.patches]


def test_copies_replace_the_object(tmp_path: Path) -> None:
    found = patches(tmp_path, 's="30" length="40" distance="20"')
    assert found == [(s - 1, s + 1, -2.0, -1.0) for s in (30.0, 50.0, 70.0)]


def test_copies_change_linearly_from_start_to_end(tmp_path: Path) -> None:
    ends = 'tStart="-1" tEnd="-3" widthStart="1" widthEnd="2" lengthStart="2" lengthEnd="4"'
    found = patches(tmp_path, f's="30" length="40" distance="20" {ends}')
    assert found == [(29.0, 31.0, -1.5, -0.5), (48.5, 51.5, -2.75, -1.25), (68.0, 72.0, -4.0, -2.0)]


def test_without_a_distance_it_is_one_patch(tmp_path: Path) -> None:
    assert patches(tmp_path, 's="30" length="40" distance="0" widthStart="3"') == [(30.0, 70.0, -3.0, 0.0)]


@pytest.mark.parametrize(
    ("repeat", "attributes", "what"),
    [
        (
            's="30" length="40" distance="0" tStart="0" tEnd="1"',
            {},
            "a continuous <repeat> of an <object> with friction",
        ),
        ('s="30" length="40" distance="5"', {"hdg": "0.3"}, "an <object> with friction that is turned"),
        ('s="30" length="40" distance="5" detachFromReferenceLine="true"', {}, "with 'detachFromReferenceLine'"),
        ('s="30" length="40" distance="1e-9"', {}, "more than 10000 copies"),
    ],
)
def test_what_is_no_rectangle_is_refused_for_its_own_reason(
    repeat: str, attributes: dict[str, str], what: str, tmp_path: Path
) -> None:
    with pytest.raises(DseError, match=what):
        patches(tmp_path, repeat, **attributes)
