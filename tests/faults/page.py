"""The tables of docs/trust.md, from what was tried."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parents[2] / "docs" / "trust.md"

FAILS = {
    "write": "writing to a file",
    "rename": "renaming a file",
    "fsync": "flushing a file to disk",
    "mmap": "mapping memory",
    "malloc": "allocating 64 KiB or more",
    "open": "opening a file to write, making a folder",
    "ftruncate": "changing a file's length",
    "fork": "starting a process or a thread",
}
WHERE = {"coordinator": "the command", "worker": "a worker", "compiler": "a compiler"}

_HEADS = ("failing call", "process", "tests", "succeeded", "stopped with a message, then succeeded", "other")


def table_of_faults(lines: Iterable[dict[str, Any]]) -> list[str]:
    """A row for each kind of call and of process, and how many in which study; *lines* as `everything` writes them."""
    lines = list(lines)
    scenarios = Counter(line["scenario"] for line in lines)
    counts: dict[tuple[str, str], list[int]] = defaultdict(lambda: [0, 0, 0, 0])
    for line in sorted(lines, key=_row):
        fault = line["fault"]
        stays = ", this and all later calls" if fault["stays"] else ""
        row = counts[f"{FAILS[fault['kind']]} (`{fault['error']}`{stays})", WHERE[fault["role"]]]
        row[0] += 1
        row[3 if line["wrong"] else 1 if line["code"] == 0 else 2] += 1
    total = [sum(column) for column in zip(*counts.values(), strict=True)]
    rows = [(*names, *map(str, row)) for names, row in counts.items()]
    studies = "; ".join(f"{count} in {name}" for name, count in sorted(scenarios.items()))
    return [*_table(_HEADS, [*rows, ("all", "", *map(str, total))]), "", f"Of these {studies}."]


def table_of_commands(lines: Iterable[dict[str, Any]]) -> list[str]:
    """A row for each command and error, what it came to; *lines* as `commands` writes them."""
    counts: dict[tuple[str, str], list[int]] = defaultdict(lambda: [0, 0, 0, 0])
    for line in sorted(lines, key=lambda line: (line["command"], line["fault"]["error"])):
        if line["happened"]:
            row = counts[line["command"], f"`{line['fault']['error']}`"]
            row[0] += 1
            row[3 if line["wrong"] else 1 if line["code"] == 0 else 2] += 1
    total = [sum(column) for column in zip(*counts.values(), strict=True)]
    rows = [(*names, *map(str, row)) for names, row in counts.items()]
    return _table(("command", "error", *_HEADS[2:]), [*rows, ("all", "", *map(str, total))])


def _row(line: dict[str, Any]) -> tuple[int, bool, str, str]:
    fault = line["fault"]
    return [*FAILS].index(fault["kind"]), fault["stays"], fault["error"], fault["role"]


def table_of_signals(signals: dict[tuple[str, str], int]) -> list[str]:
    """A row for each signal; *signals* sent by (name, target)."""
    targets = ("worker", "coordinator", "group")
    names = dict.fromkeys(name for name, _ in sorted(signals))
    rows = [(f"SIG{name}", *(str(signals.get((name, target), 0)) for target in targets)) for name in names]
    return _table(("signal", "to a worker", "to the command", "to all"), rows)


def write(name: str, lines: Sequence[str]) -> None:
    """Put *lines* between the marks of *name*."""
    begin, end = (f"<!-- {name}: {word} -->" for word in ("begin", "end"))
    text = PAGE.read_text(encoding="utf-8")
    pattern = re.compile(f"{re.escape(begin)}.*?{re.escape(end)}", re.DOTALL)
    PAGE.write_text(pattern.sub(lambda _: "\n".join([begin, *lines, end]), text), encoding="utf-8")


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    words = sum(not cell.isdigit() for cell in rows[0])
    marks = ["---"] * words + ["--:"] * (len(heads) - words)
    return [f"| {' | '.join(cells)} |" for cells in (heads, marks, *rows)]
