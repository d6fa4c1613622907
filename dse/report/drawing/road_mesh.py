"""The surface of a road network as a mesh, for engines: glTF 2.0 (``.glb``) and Wavefront (``.obj``).

Both have y up and are right-handed: a place (x, y, z) of dse is (x, z, -y) there. Lengths are in m. Each lane is a band
of two triangles between neighbouring points of its borders; lanes for vehicles and other lanes are two groups.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.errors import fail
from dse.report.drawing.road_picture import Strip
from dse.scratch import write_whole

ENDINGS = (".glb", ".obj")

_COLOURS = {"lanes": (0.05, 0.05, 0.06), "verges": (0.09, 0.10, 0.08)}  # linear
_FLOAT, _INDEX, _VERTICES, _ELEMENTS = 5126, 5125, 34962, 34963  # of glTF


def write_mesh(strips: Sequence[Strip], name: str, target: Path) -> int:
    """Write the surfaces of *strips* by the ending of *target*; returns the number of triangles.

    Raises DseError for another ending.
    """
    if (ending := target.suffix.lower()) not in ENDINGS:
        raise fail(f"a mesh is not written as '{target.name}'", hint=f"the ending is one of {', '.join(ENDINGS)}")
    groups = {group: _mesh([strip for strip in strips if strip.is_driven == (group == "lanes")]) for group in _COLOURS}
    groups = {group: mesh for group, mesh in groups.items() if len(mesh[1])}
    write_whole(target, _glb(groups, name) if ending == ".glb" else "".join(_obj(groups, name)))
    return sum(len(faces) for _, faces in groups.values())


Mesh = tuple[NDArray[np.float64], NDArray[np.uint32]]


def _mesh(strips: Sequence[Strip]) -> Mesh:
    """Points (n, 3) and triangles (m, 3), counter-clockwise seen from above."""
    points: list[NDArray[np.float64]] = [np.zeros((0, 3))]
    faces: list[NDArray[np.uint32]] = [np.zeros((0, 3), dtype=np.uint32)]
    first = 0
    for strip in strips:
        sides = ((strip.left, strip.left_height), (strip.right, strip.right_height))
        left, right = (np.column_stack([side[:, 0], height, -side[:, 1]]) for side, height in sides)
        count = len(left)
        here = np.arange(count - 1, dtype=np.uint32) + first
        over = here + count  # on the right
        faces.append(
            np.concatenate([np.column_stack([here, over, here + 1]), np.column_stack([here + 1, over, over + 1])])
        )
        points += [left, right]
        first += 2 * count
    return np.concatenate(points), np.concatenate(faces)


def _obj(groups: dict[str, Mesh], name: str) -> Iterator[str]:
    yield f"# {' '.join(name.split())}\n"
    first = 1
    for group, (points, faces) in groups.items():
        yield f"o {group}\n"
        yield from (f"v {x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in points)
        yield from (f"f {a} {b} {c}\n" for a, b, c in faces.astype(int) + first)
        first += len(points)


def _glb(groups: dict[str, Mesh], name: str) -> bytes:
    """One node and one mesh for each group; points as float32, which are exact to 0.1 mm within 1 km."""
    data, views, accessors, meshes, materials = b"", [], [], [], []
    for number, (group, (points, faces)) in enumerate(groups.items()):
        places = points.astype("<f4")
        for values, target in ((places, _VERTICES), (faces.astype("<u4"), _ELEMENTS)):
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes, "target": target})
            data += values.tobytes()
        extent = {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
        accessors += [
            {"bufferView": 2 * number, "componentType": _FLOAT, "count": len(places), "type": "VEC3", **extent},
            {"bufferView": 2 * number + 1, "componentType": _INDEX, "count": faces.size, "type": "SCALAR"},
        ]
        surface = {"baseColorFactor": [*_COLOURS[group], 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9}
        materials.append({"name": group, "pbrMetallicRoughness": surface, "doubleSided": True})
        primitive = {"attributes": {"POSITION": 2 * number}, "indices": 2 * number + 1, "material": number}
        meshes.append({"name": group, "primitives": [primitive]})
    document = {
        "asset": {"version": "2.0", "generator": "dse"},
        "scene": 0,
        "scenes": [{"name": name, "nodes": [*range(len(meshes))]}],
        "nodes": [{"name": mesh["name"], "mesh": number} for number, mesh in enumerate(meshes)],
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    chunks = ((text + b" " * (-len(text) % 4), b"JSON"), (data + b"\0" * (-len(data) % 4), b"BIN\0"))
    body = b"".join(struct.pack("<I4s", len(chunk), kind) + chunk for chunk, kind in chunks)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body
