"""Meshes of roads for engines: read back as their formats define them."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from dse.errors import DseError
from dse.report import write_mesh
from dse.report.drawing.road_picture import Strip

# A lane of 100 m that climbs by 4 m to the north-east, and a verge to its right.
ALONG = np.column_stack([np.linspace(0, 60, 5), np.linspace(0, 80, 5)])
TO_LEFT = np.array([-0.8, 0.6])
HEIGHT = np.linspace(1, 5, 5)


def strip(left: float, right: float, *, is_driven: bool) -> Strip:
    sides = ALONG + left * TO_LEFT, ALONG + right * TO_LEFT
    return Strip(*sides, HEIGHT, HEIGHT, is_driven=is_driven, is_inside=False)


STRIPS = [strip(2, -2, is_driven=True), strip(-2, -3, is_driven=False)]


def area(points: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """The sum of the triangles' areas as vectors along their normals."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    return np.asarray(np.cross(b - a, c - a).sum(axis=0) / 2)


@pytest.mark.parametrize("group", [0, 1])
def test_a_glb_file_has_the_surface_of_each_group(tmp_path: Path, group: int) -> None:
    assert write_mesh(STRIPS, "a road", tmp_path / "road.glb") == 16
    data = (tmp_path / "road.glb").read_bytes()
    magic, version, size, length, kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, size, kind) == (b"glTF", 2, len(data), b"JSON")
    document = json.loads(data[20 : 20 + length])
    (count, other) = struct.unpack_from("<I4s", data, 20 + length)
    body = data[28 + length :]
    assert (len(body), other) == (count, b"BIN\0")
    mesh = document["meshes"][group]
    assert mesh["name"] == ("lanes", "verges")[group]

    def read(accessor: int, kind: str) -> NDArray[np.float64]:
        view = document["bufferViews"][document["accessors"][accessor]["bufferView"]]
        found = np.frombuffer(body[view["byteOffset"] :][: view["byteLength"]], kind)
        assert found.size == document["accessors"][accessor]["count"] * (3 if kind == "<f4" else 1)
        return found.reshape(-1, 3).astype(float)

    primitive = mesh["primitives"][0]
    points, faces = read(primitive["attributes"]["POSITION"], "<f4"), read(primitive["indices"], "<u4").astype(int)
    lowest = document["accessors"][primitive["attributes"]["POSITION"]]["min"]
    assert points.min(axis=0).tolist() == lowest
    # y is up: over the plane there are 4 m or 1 m of width, 100 m long, which look up.
    assert area(points, faces)[1] == pytest.approx((400, 100)[group], rel=1e-5)
    assert points[0] == pytest.approx([-0.8 * (2, -2)[group], 1.0, -0.6 * (2, -2)[group]], abs=1e-6)


def test_an_obj_file_has_the_same_surface(tmp_path: Path) -> None:
    assert write_mesh(STRIPS, "a\nroad", tmp_path / "road.obj") == 16
    lines = (tmp_path / "road.obj").read_text("utf-8").splitlines()
    assert lines[0] == "# a road"
    points = np.array([line.split()[1:] for line in lines if line.startswith("v ")], dtype=float)
    faces = np.array([line.split()[1:] for line in lines if line.startswith("f ")], dtype=int) - 1
    assert area(points, faces)[1] == pytest.approx(500, rel=1e-5)
    assert [line for line in lines if line.startswith("o ")] == ["o lanes", "o verges"]


def test_a_mesh_of_another_ending_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DseError, match=r"a mesh is not written as 'road.fbx'"):
        write_mesh(STRIPS, "a road", tmp_path / "road.fbx")
