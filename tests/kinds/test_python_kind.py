"""Classes in Python as components: their contract, and what is told when they break it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from kinds.examples import CLASS, written

from dse import DseError, Waveforms, simulate
from dse.fmu.component_build import build
from dse.loading.component.kind import kind_of
from dse.testing.kinds import lay_out, the_component

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="FMUs with a process beside them need POSIX")

INTERFACES = """\
interfaces:
  gain:
    inputs: {u: m, on: bool, mode: "enum[slow, fast]", count: int}
    outputs: {y: m, off: bool, other: "enum[slow, fast]", next: int}
"""
ALL = """\
class Twice:
    def __init__(self, parameters):
        self.parameters = parameters
        self.y = 0.0

    def step(self, inputs, h):
        self.y += h * self.parameters["factor"] * (1.0 - self.y)
        other = {"slow": "fast", "fast": "slow"}[inputs["mode"]]
        return {"y": self.y, "off": not inputs["on"], "other": other, "next": inputs["count"] + 1}
"""
SOURCE = "{kind: python, files: [twice.py]}"
BODY = CLASS.splitlines()[-1].strip()


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DSE_CACHE", str(tmp_path / "cache"))


def component(folder: Path, text: str, source: str = SOURCE, interfaces: str = INTERFACES, **more: str | bytes):
    files = {**written(source), "interfaces.yaml": interfaces, "twice/twice.py": text}
    return the_component(lay_out({**files, **{f"twice/{name}": content for name, content in more.items()}}, folder))


def run(folder: Path, text: str, *, source: str = SOURCE, version: int = 2, **settings: float | str) -> Waveforms:
    archive = build(component(folder, text, source), version=version)
    return simulate(archive, stop=1.0, step=0.01, set=settings, record=["y", "off", "other", "next"])


@pytest.mark.parametrize(
    ("text", "where", "what", "hint"),
    [
        ("class Twice:\n    def step(:\n", ":2:14", "it is not Python: invalid syntax", ""),
        ("class Twise: ...\n", "", "there is no class 'Twice'", "did you mean 'Twise'?"),
        ("x = 1\n", "", "there is no class 'Twice'", "class Twice: with __init__(self, parameters) and step"),
        ("\nclass Twice:\n    def stop(self): ...\n", ":2:1", "class 'Twice' has no method 'step'", "def step(self"),
        ("x = '\\0'\n\0", "", "it is not Python: ", ""),
        (f"x = {'-' * 100_000}1\n", "", "it is nested too deeply", ""),
    ],
)
def test_what_is_wrong_with_the_file_is_told_without_running_it(tmp_path, text, where, what, hint):
    found = component(tmp_path, text)
    with pytest.raises(DseError) as caught:
        kind_of(found).check(found, found.source)
    (problem,) = caught.value.problems
    assert str(problem.where).endswith(f"twice.py{where}")
    assert problem.what.startswith(what)
    assert problem.hint.startswith(hint)


def test_texts_are_refused_by_name(tmp_path):
    found = component(tmp_path, CLASS, interfaces=INTERFACES.replace("u: m", "u: string"))
    with pytest.raises(DseError, match="port 'u' is a string: a class in Python gets numbers only"):
        kind_of(found).check(found, found.source)


@pytest.mark.parametrize("source", ["{kind: python}", "{kind: python, files: [twice.py], step: 0 s}"])
def test_keys_are_checked(tmp_path, source):
    with pytest.raises(DseError, match=r"component\.yaml:3:"):
        component(tmp_path, CLASS, source)


@pytest.mark.thorough
@pytest.mark.parametrize("version", [2, 3])
def test_values_of_all_kinds_go_in_and_out(tmp_path, version):
    found = run(tmp_path, ALL, version=version, factor=np.float64(3), on=True, mode="fast", count=7)
    # Euler's method: 1 - (1 - 3 h)^n.
    assert found["y"].tolist() == pytest.approx([1 - 0.97**n for n in range(101)], abs=1e-12)
    assert [set(found[name].tolist()) for name in ("off", "other", "next")] == [{0.0}, {0.0}, {8.0}]


@pytest.mark.thorough
def test_a_sampled_class_runs_at_its_own_steps(tmp_path):
    counts = "self.n = getattr(self, 'n', -1) + 1"
    returns = 'return {"y": self.n * 10.0 + h, "off": False, "other": "slow", "next": 0}'
    text = CLASS.replace(BODY, f"{counts}\n        {returns}")
    found = run(tmp_path, text, source="{kind: python, files: [twice.py], step: 250 ms}")
    # At the start with h = 0, then from 0 s on every 250 ms.
    assert found["y"][[0, 1, 25, 26, 50, 51, 100]].tolist() == [0.0, 10.25, 10.25, 20.25, 20.25, 30.25, 40.25]


@pytest.mark.thorough
def test_other_files_are_beside_it_and_every_run_begins_with_the_same_state(tmp_path):
    text = (
        "from pathlib import Path\n\nimport helper\n\n"
        "OFFSET = float(Path(__file__).with_name('offset.txt').read_text())\n\n\n"
        "class Mine:\n    def __init__(self, parameters):\n        helper.made += 1\n\n"
        "    def step(self, inputs, h):\n"
        "        return {'y': OFFSET + helper.made, 'off': False, 'other': 'slow', 'next': 0}\n"
    )
    source = "{kind: python, files: [twice.py, helper.py, offset.txt], class_name: Mine}"
    more = {"helper.py": "made = 0\n", "offset.txt": "0.5"}
    archive = build(component(tmp_path, text, source, **more))
    for _ in range(2):
        assert set(simulate(archive, stop=1.0, step=0.1)["y"].tolist()) == {1.5}


BROKEN = {
    "return 1 / 0": "twice.py:6: ZeroDivisionError: division by zero",
    "return 3.0": "step returned float, not a dict of outputs by name",
    'return {"y": 0.0, "z": 1}': "what step returned lacks off, other, next and has z, no outputs",
    'return {"y": "much", "off": False, "other": "slow", "next": 0}': "'y' is 'much', not a number",
    'return {"y": 0.0, "off": 2, "other": "slow", "next": 0}': "'off' is 2, neither True nor False",
    'return {"y": 0.0, "off": False, "other": "quick", "next": 0}': "'other' is 'quick', none of slow, fast",
    'return {"y": 0.0, "off": False, "other": "slow", "next": 0.5}': "'next' is 0.5, not a whole number of 32 bits",
    "raise SystemExit(4)": "SystemExit: 4",
    "import os; os._exit(4)": "the process of the class has ended with the exit code 4",
    "import os; os.kill(os.getpid(), 11)": "the process of the class has crashed (SIGSEGV)",
}


@pytest.mark.thorough
def test_what_the_class_does_wrong_is_told_with_its_line(tmp_path):
    for number, (line, told) in enumerate(BROKEN.items()):
        text = CLASS.replace(BODY, line)
        with pytest.raises(DseError) as caught:
            run(tmp_path / str(number), text)
        assert told in str(caught.value)


@pytest.mark.thorough
def test_a_file_that_cannot_be_imported_is_told(tmp_path):
    with pytest.raises(DseError, match=r"twice\.py:1: ModuleNotFoundError: No module named 'nowhere'"):
        run(tmp_path, "import nowhere\n" + CLASS)
