"""Files of a workspace that were not there before: all of them, or none."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from dse.errors import Location, Problem, fail, raise_if_any


def write_new(texts: Mapping[Path, str], copies: Mapping[Path, Path]) -> None:
    """Write *texts*, and *copies* of other files, by path.

    Raises DseError if one is there already or cannot be written; then there is none.
    """
    files = (*texts, *copies)
    raise_if_any(
        Problem("the file already exists", Location(str(path)), "move it away; nothing is overwritten")
        for path in files
        if path.exists()
    )
    try:
        for path in files:
            path.parent.mkdir(parents=True, exist_ok=True)
        for path, source in copies.items():
            shutil.copyfile(source, path)
        for path, text in texts.items():
            path.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        for path in files:
            path.unlink(missing_ok=True)
            with suppress(OSError):  # there is something else in the folder
                path.parent.rmdir()
        raise fail(f"cannot be written: {error.strerror or error}", Location(str(error.filename))) from error
