"""What SECURITY.md says of the code: nothing is evaluated, and pickles are read in a few known places."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]

UNPICKLING = {
    "dse/api/studies/prepared_run.py": "what this user's command has kept in the cache, beside the libraries it loads",
    "dse/exploration/packed_configuration.py": "a configuration of our coordinator, on another machine or compared",
    "dse/exploration/remote/messages.py": "what our coordinator has sent to another machine",
    "dse/exploration/supervision/channel.py": "what a supervisor has sent to its worker",
    "dse/exploration/supervision/guarded_runner.py": "a configuration that a supervisor has written for its worker",
    "dse/live/run_process.py": "a run that the server of test drives has written for the process of its session",
    "dse/testing/metrics.py": "what the test itself has pickled",
}
"""Where a pickle is read, and whose it is."""


def files_with(pattern: str) -> set[str]:
    """Files of dse in whose code there is what *pattern* describes."""
    found = re.compile(pattern)
    texts = {path: path.read_text("utf-8") for path in (ROOT / "dse").rglob("*.py")}
    return {path.relative_to(ROOT).as_posix() for path, text in texts.items() if found.search(text)}


def test_pickles_are_read_only_where_they_are_known_to_be_ours() -> None:
    assert (
        files_with(r"\bpickle\.(loads?\(|Unpickler\b)|\b(marshal|shelve|joblib|dill|cloudpickle)\.")
        == UNPICKLING.keys()
    )


def test_nothing_is_evaluated_and_no_shell_is_asked() -> None:
    assert files_with(r"(?<![\w.])(eval|exec|__import__)\(|\bos\.(system|popen)\(|shell=True") == set()
