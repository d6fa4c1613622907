"""docs/udp_clients.md: it names every check, its YAML works, and its C# is what stands in clients/."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from command_line import run_dse

from dse.live import client_check, world_check
from dse.live.checks import Findings

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "udp_clients.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return [re.sub("(?m)^   ", "", block) for block in re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)]


def test_every_check_has_its_line_in_the_order_of_the_command() -> None:
    rows = re.findall(r"(?m)^\| ([a-zA-Z ]+) \| ", TEXT)
    for names in (world_check.NAMES, client_check.NAMES):
        assert [check.name for check in Findings(names).listed()] == list(names)
        assert any(rows[start : start + len(names)] == list(names) for start in range(len(rows)))


@pytest.mark.thorough
def test_its_component_has_the_layout_of_the_example_worlds(tmp_path: Path) -> None:
    (text,) = blocks("yaml")
    _, *files = re.split(r"(?m)^\s*# (components/\S+)\n", text)
    for name, content in zip(files[::2], files[1::2], strict=True):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8")
    shown = run_dse(tmp_path, "udp", "layout", "outside", cache=tmp_path / "cache")
    assert shown.returncode == 0, shown.stderr
    assert "36 bytes" in shown.stdout
    assert "gap [m]" in shown.stdout


def test_what_its_scene_calls_is_there() -> None:
    (code,) = blocks("csharp")
    library = (ROOT / "clients/unity/Runtime/DseUdp.cs").read_text(encoding="utf-8")
    for called in set(re.findall(r"(?:world|request|Happened)\.([A-Z]\w+)", code)):
        assert re.search(rf"\b{called}\b", library), called


def test_its_links_lead_somewhere() -> None:
    for link in re.findall(r"\]\((\.\./[^)#]+)", TEXT):
        assert (ROOT / "docs" / link).exists(), link
