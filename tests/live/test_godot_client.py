"""clients/godot, run in Godot 3: its scripts are written in what Godot 3 and 4 have in common."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from background import LIMIT
from command_line import run_dse
from live_worlds import free_port, running

PROJECT = Path(__file__).parents[2] / "clients" / "godot"
GODOT = shutil.which("godot3-server") or ""
RUN = """extends SceneTree
func _init():
	var node = load("res://outside.gd").new()
	node.port = PORT
	get_root().add_child(node)
	print("a world at 127.0.0.1:%d" % node.port)
"""
SHOW = """extends SceneTree
const DseFrame = preload("res://dse/dse_frame.gd")
func _init():
	print(DseFrame.position(3.0, 4.0, 5.0))
	for heading in [-3.0, 0.3, 1.5]:
		var node = Spatial.new()
		node.rotation = DseFrame.rotation(heading, 0.1, 0.2)
		var forward = -node.transform.basis.z
		var left = -node.transform.basis.x
		print(abs(DseFrame.heading(forward) - heading) < 1e-6, forward.y < -0.09, left.y > 0.1)
	var movers = load("res://dse/dse_movers.gd").new()
	for name in ["box", "truck"]:
		var template = Spatial.new()
		template.name = name
		movers.add_child(template)
	movers._enter_tree()
	for kind in [1, 2, 0]:
		movers.put(4, kind, Vector3(1.8, 1.5, 4.5), 11.0, 2.0, 1.0, 0.0)
		var shown = movers.get_child(movers.get_child_count() - 1)
		print(shown.transform.origin, shown.scale, shown.visible, movers._shown.size())
	quit()
"""


@pytest.fixture
def project(tmp_path: Path) -> list[str]:
    """The command that runs a script in the project, opened with Godot 3."""
    if not GODOT:
        pytest.skip("no Godot 3: godot3-server")
    shutil.copytree(PROJECT, tmp_path / "godot")
    (tmp_path / "godot" / "project.godot").write_text("config_version=4\n", encoding="utf-8")
    return [GODOT, "--path", str(tmp_path / "godot"), "-s", "run.gd"]


@pytest.mark.thorough
def test_its_scripts_pass_the_check(project: list[str], tmp_path: Path) -> None:
    port = free_port()
    (tmp_path / "godot" / "run.gd").write_text(RUN.replace("PORT", str(port)), encoding="utf-8")
    with running(project):
        options = ["--out", "1", "--back", "3", "--steps", "50", "--timeout", str(LIMIT)]
        done = run_dse(tmp_path, "udp", "check", f"127.0.0.1:{port}", *options, cache=tmp_path / "cache")
    assert done.returncode == 0, done.stdout


@pytest.mark.thorough
def test_its_axes_are_those_of_exported_roads_and_road_users_are_templates_or_boxes(
    project: list[str], tmp_path: Path
) -> None:
    (tmp_path / "godot" / "run.gd").write_text(SHOW, encoding="utf-8")
    said = subprocess.run(project, check=True, capture_output=True, text=True, timeout=LIMIT).stdout
    lines = [line for line in said.splitlines() if line.startswith(("(", "True", "False"))]
    # dse export mesh writes (x, z, -y), which Godot imports as it is.
    assert lines[0] == "(3, 5, -4)"
    assert lines[1:4] == ["TrueTrueTrue"] * 3
    # A car without a template is a box, whose middle is 0.75 m above the road; a truck has its origin on the road.
    assert lines[4] == "(11, 1.75, -2)(1.8, 1.5, 4.5)True1"
    assert lines[5] == "(11, 1, -2)(1, 1, 1)True1"
    assert lines[6].endswith("0")


def test_its_scene_names_files_and_parts_that_there_are() -> None:
    scene = (PROJECT / "outside.tscn").read_text(encoding="utf-8")
    for path in re.findall(r'path="res://([^"]+)"', scene):
        assert (PROJECT / path).is_file()
    for kind in ("Sub", "Ext"):
        defined = re.findall(rf'\[{kind.lower()}_resource [^\]]*id="([^"]+)"\]', scene)
        assert {*re.findall(rf'{kind}Resource\("([^"]+)"\)', scene)} == {*defined}
    nodes = {".": "Outside"} | dict.fromkeys(("Answers",), "")
    for name, parent in re.findall(r'\[node name="([^"]+)" type="[^"]+" parent="([^"]+)"\]', scene):
        assert parent in nodes
        nodes[name if parent == "." else f"{parent}/{name}"] = parent
