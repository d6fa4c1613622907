"""Every fault there is: the n-th call of each kind, for every n until the study does not get that far.

``python tests/faults/everything.py --every 10`` tries each tenth; what came of each goes into a file of lines of JSON,
one a fault, and what is in it already is not tried again.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Container, Iterable, Iterator
from dataclasses import asdict
from itertools import product
from pathlib import Path

import compile_cache
from faults import page, shim
from faults.undisturbed import Case, Scenario, Studies

KINDS = (
    ("write", "ENOSPC", False),
    ("write", "ENOSPC", True),
    ("write", "EIO", False),
    ("rename", "EIO", False),
    ("fsync", "EIO", False),
    ("mmap", "ENOMEM", False),
    ("malloc", "ENOMEM", False),
    ("open", "ENOSPC", False),
    ("open", "ENOSPC", True),
    ("ftruncate", "ENOSPC", False),
    ("fork", "EAGAIN", False),
    ("fork", "EAGAIN", True),
)
"""What fails, how, and whether it stays so until the command ends."""


SCENARIOS = (
    Scenario("all"),
    Scenario("near_boundary"),
    Scenario("none"),
    Scenario("all", cold=True),
    Scenario("none", fresh=True),
)


def calls(count: int, most: int, shift: int) -> range:
    """Which of about *count* calls to let fail: about *most*, evenly, or all with 0; *shift* chooses which."""
    every = max(1, count // most) if most else 1
    # The last may or may not be there the next time: on beyond what was counted.
    return range(1 + shift % every, count + count // 4 + 2, every)


def tried(studies: Studies, scenario: Scenario, faults: Iterable[shim.Fault], known: Container[str]) -> Iterator[Case]:
    """What came of each of *faults*, until the study does not get as far; those *known* are left out."""
    for fault in faults:
        if f"{scenario}: {fault}" in known:
            continue
        case = studies.disturbed(scenario, fault)
        if not case.happened:
            return
        yield case


def main() -> None:
    """Try them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--most", type=int, default=0, help="about so many calls of a kind, not all")
    parser.add_argument("--shift", type=int, default=0, help="which of them")
    parser.add_argument("--minutes", type=float, default=1e9, help="end after so many")
    parser.add_argument("--scenario", type=int, nargs="*", default=range(len(SCENARIOS)))
    parser.add_argument("--role", nargs="*", default=shim.ROLES[:2])
    parser.add_argument("--kind", nargs="*", default=shim.KINDS)
    parser.add_argument("--file", type=Path, default=Path("out/faults.jsonl"))
    parser.add_argument("--write", action="store_true", help="put what is in the file into docs/trust.md, too")
    options = parser.parse_args()
    options.file.parent.mkdir(parents=True, exist_ok=True)
    options.file.touch()
    try:
        _try(options)
    finally:
        if options.write:
            page.write("faults", page.table_of_faults(map(json.loads, options.file.open(encoding="utf-8"))))
            subprocess.run([sys.executable, "-m", "faults.commands", "--write"], check=True)


def _try(options: argparse.Namespace) -> None:
    known = {f"{line['scenario']}: {line['name']}" for line in map(json.loads, options.file.open(encoding="utf-8"))}
    until = time.monotonic() + 60 * options.minutes
    with tempfile.TemporaryDirectory() as scratch, options.file.open("a", encoding="utf-8", buffering=1) as lines:
        compiled = Path(scratch, "compiled")
        compiled.mkdir()
        compile_cache.use(compiled, optimized=True)
        studies = Studies(Path(scratch), shim.build(Path(scratch)))
        for scenario in (SCENARIOS[index] for index in options.scenario):
            counts = studies.counts(scenario)
            for (kind, error, stays), role in product(KINDS, options.role):
                if kind not in options.kind:
                    continue
                numbers = calls(counts[role, kind], options.most, options.shift)
                faults = (shim.Fault(kind, role, error, nth, stays) for nth in numbers)
                for case in tried(studies, scenario, faults, known):
                    told = asdict(case) | {"scenario": str(scenario), "name": str(case.fault)}
                    lines.write(json.dumps(told) + "\n")
                    if case.wrong or case.litter:
                        print(f"{scenario}: {case.fault}: {case.call}\n    {case.wrong} {case.litter}", flush=True)
                    if time.monotonic() > until:
                        return


if __name__ == "__main__":
    main()
