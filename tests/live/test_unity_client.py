"""clients/unity compiled against the signatures of Unity that it uses, and the scene of its README run."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "clients" / "unity"
pytestmark = pytest.mark.thorough


def test_its_axes_are_those_of_exported_roads(unity_world: list[str]) -> None:
    lines = said(unity_world, "frames")
    # dse export mesh writes (x, z, -y), and Unity negates the first.
    assert lines[0] == "-3 5 -4"
    assert lines[1:] == ["True"] * 9


def test_road_users_are_prefabs_of_their_class_or_boxes(unity_world: list[str]) -> None:
    # Class none, then a car without a prefab, whose middle is 0.75 m above the road, then a lorry with one.
    assert said(unity_world, "movers") == ["none", "Cube -11 1.75 4.5", "lorry(Clone) -12 1 1"]


def said(scene: list[str], word: str) -> list[str]:
    return subprocess.run([*scene, word], check=True, capture_output=True, text=True).stdout.split("\n")[:-1]


def test_its_manifest_names_the_version_of_dse() -> None:
    import dse

    manifest = json.loads((PACKAGE / "package.json").read_text(encoding="utf-8"))
    assert manifest["version"] == dse.__version__
    assert json.loads((PACKAGE / "Runtime" / "Dse.Udp.asmdef").read_text(encoding="utf-8"))["name"] == "Dse.Udp"
