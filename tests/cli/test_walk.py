"""The walk of CONTRIBUTING through the house is taken: every step is where it says, and comes when it says."""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STEP = re.compile(r"^\| `(dse/\S+\.py)` \| `([\w.]+)` \| (.*) \|$", re.MULTILINE)

WATCHED = """
import json, sys, threading
from dse.cli import main
steps, seen = [tuple(step) for step in json.loads(sys.argv[1])], []
files = {}
for file, name in steps:
    files.setdefault(name, []).append(file)

def watch(frame, event, argument):
    if event == "call" and frame.f_code.co_qualname in files:
        name = frame.f_code.co_qualname
        step = next(((file, name) for file in files[name] if frame.f_code.co_filename.endswith(file)), None)
        if step and step not in seen:
            seen.append(step)

sys.argv = ["dse", "explore", "small", "--fresh", "-o", sys.argv[2]]
sys.setprofile(watch)
threading.setprofile(watch)
try:
    main()
finally:
    sys.setprofile(None)
    print("SEEN", json.dumps(seen))
"""


def steps() -> list[tuple[str, str, str]]:
    return STEP.findall((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"))


def defined(file: str) -> set[str]:
    """The functions of a file, methods with their class."""
    names = set()
    for node in ast.parse((ROOT / file).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            names.add(node.name)
        elif isinstance(node, ast.ClassDef):
            names |= {f"{node.name}.{one.name}" for one in node.body if isinstance(one, ast.FunctionDef)}
    return names


def test_every_step_of_the_walk_is_where_it_says():
    assert len(steps()) > 20
    assert [(file, name) for file, name, _ in steps() if name not in defined(file)] == []


@pytest.mark.thorough
def test_the_walk_is_what_happens(example: Path, cache: Path, tmp_path: Path):
    told = [(file, name) for file, name, what in steps() if not what.startswith("*in a worker:*")]
    command = [sys.executable, "-c", WATCHED, json.dumps(told), str(tmp_path / "out")]
    where = {**os.environ, "DSE_CACHE": str(cache)}
    done = subprocess.run(command, cwd=example, env=where, capture_output=True, text=True, check=False)
    assert "SEEN" in done.stdout, done.stderr
    assert [tuple(step) for step in json.loads(done.stdout.split("SEEN", 1)[1])] == told
