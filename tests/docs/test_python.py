"""docs/python.md: its code runs as it stands, from top to bottom; and the examples of the public names, after it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from dse.api.spaces.design import Design

TEXT = (Path(__file__).parents[2] / "docs" / "python.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
EXAMPLES = """
import doctest
from pathlib import Path
runner = doctest.DocTestRunner()
for name in dse.__all__:
    for test in doctest.DocTestFinder().find(getattr(dse, name), name, module=False, globs={"dse": dse, "Path": Path}):
        runner.run(test)
assert not runner.failures, runner.summarize()
assert runner.tries > 10
"""


@pytest.mark.thorough
def test_the_code_shown_runs(tmp_path, built_before):
    subprocess.run([sys.executable, "-m", "dse", "init", "study"], cwd=tmp_path, check=True, capture_output=True)
    script = tmp_path / "page.py"  # classes without a file have no source text
    script.write_text("\n".join([*BLOCK.findall(TEXT), EXAMPLES]), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(script)],
        cwd=tmp_path / "study",
        env={**os.environ, "DSE_CACHE": str(built_before(tmp_path / "cache"))},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_question_is_named():
    questions = [name for name, value in vars(Design).items() if callable(value) and not name.startswith("_")]
    missing = [name for name in questions if not re.search(rf"[`.]{name}\b", TEXT)]
    assert len(questions) > 10
    assert not missing
