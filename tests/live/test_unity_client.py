"""clients/unity compiled against the signatures of Unity that it uses, and the scene of its README run."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from background import LIMIT
from command_line import run_dse
from live_worlds import free_port, running

PACKAGE = Path(__file__).parents[2] / "clients" / "unity"
UNITY = Path(__file__).parent / "unity"
pytestmark = [
    pytest.mark.thorough,
    pytest.mark.skipif(not (shutil.which("mcs") and shutil.which("mono")), reason="no C# compiler: mcs and mono"),
]


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    folder = tmp_path_factory.mktemp("unity")
    (code,) = re.findall(r"```csharp\n(.*?)```", (PACKAGE / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    (folder / "Outside.cs").write_text(re.sub("(?m)^   ", "", code), encoding="utf-8")
    sources = [*sorted((PACKAGE / "Runtime").glob("*.cs")), *sorted(UNITY.glob("*.cs")), folder / "Outside.cs"]
    made = folder / "Scene.exe"
    options = ["-langversion:7", "-warnaserror", "-nowarn:0649", f"-out:{made}"]
    subprocess.run(["mcs", *options, *map(str, sources)], check=True)
    return ["mono", str(made)]


def test_its_scene_passes_the_check(scene: list[str], tmp_path: Path) -> None:
    port = free_port()
    with running([*scene, str(port)]):
        words = [
            "udp",
            "check",
            f"127.0.0.1:{port}",
            "--out",
            "1",
            "--back",
            "3",
            "--steps",
            "50",
            "--timeout",
            str(LIMIT),
        ]
        done = run_dse(tmp_path, *words, cache=tmp_path / "cache")
    assert done.returncode == 0, done.stdout


def test_its_axes_are_those_of_exported_roads(scene: list[str]) -> None:
    lines = said(scene, "frames")
    # dse export mesh writes (x, z, -y), and Unity negates the first.
    assert lines[0] == "-3 5 -4"
    assert lines[1:] == ["True"] * 9


def test_road_users_are_prefabs_of_their_class_or_boxes(scene: list[str]) -> None:
    # Class none, then a car without a prefab, whose middle is 0.75 m above the road, then a lorry with one.
    assert said(scene, "movers") == ["none", "Cube -11 1.75 4.5", "lorry(Clone) -12 1 1"]


def said(scene: list[str], word: str) -> list[str]:
    return subprocess.run([*scene, word], check=True, capture_output=True, text=True).stdout.split("\n")[:-1]


def test_its_manifest_names_the_version_of_dse() -> None:
    import dse

    manifest = json.loads((PACKAGE / "package.json").read_text(encoding="utf-8"))
    assert manifest["version"] == dse.__version__
    assert json.loads((PACKAGE / "Runtime" / "Dse.Udp.asmdef").read_text(encoding="utf-8"))["name"] == "Dse.Udp"
