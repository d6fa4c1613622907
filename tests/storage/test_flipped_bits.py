"""A bit that changed in `study.sqlite`: right results or one error, and never a traceback."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from dse.domain.definition import StudyDefinition
from dse.domain.run import Run
from dse.errors import DseError
from dse.storage.checks import Checks
from dse.storage.export.tables import EXPORTS
from dse.storage.folder import StudyFolder

_PAGE = 4096


def exported(path: Path) -> dict[str, object]:
    with StudyFolder.open(path) as folder:
        folder.lost()
        folder.attempts()
        return {"kept": folder.kept(), **{name: export(folder) for name, export in EXPORTS.items()}}


def gone_on(path: Path, definition: StudyDefinition) -> object:
    with StudyFolder.resume(path, definition) as folder:
        folder.table()
        return folder.finished()


@pytest.mark.thorough
def test_a_flipped_bit_is_found_or_does_not_matter(
    stored: Path, definition: StudyDefinition, runs: list[Run], add: Callable[[StudyFolder, Run], None]
) -> None:
    with StudyFolder.resume(stored, definition) as folder:
        folder.add_kept((0, 1), "")
        numbers = np.array([0, 2])
        folder.add_checks(Checks(numbers, np.full((2, 2), 0.25), np.array([[1, 3], [2, 0]]), {2: "with half the step"}))
    file = stored / "study.sqlite"
    whole = file.read_bytes()
    expected = exported(stored)
    finished = gone_on(stored, definition)
    came = Counter[str]()
    chance = random.Random(5)  # noqa: S311  # places to try
    starts = [page + at for page in range(0, len(whole), _PAGE) for at in chance.sample(range(12), 6)]
    filled = [at for at, byte in enumerate(whole) if byte]
    for at in [*starts, *chance.sample(filled, min(400, len(filled)))]:
        data = bytearray(whole)
        data[at] ^= 1 << chance.randrange(8)
        for left in stored.glob("study.sqlite*"):
            left.unlink()
        file.write_bytes(data)
        for read, right in ((lambda: exported(stored), expected), (lambda: gone_on(stored, definition), finished)):
            try:
                assert read() == right, at
                came["right"] += 1
            except DseError as error:
                assert len(error.problems) == 1, at  # noqa: PT017
                came["found"] += 1
    assert min(came["right"], came["found"]) > 50
