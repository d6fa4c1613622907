"""Where the cache is, and the workspace around a path; in strings, as pathlib costs more than a kept answer."""

from __future__ import annotations

import os
import stat

OUT = "out"
"""The folder of a workspace for results, unless the user names another."""

STUDY, RATING, PROCEDURE = NO_BENCHES = ".pet.yaml", ".rating.yaml", ".procedure.yaml"
"""How the names of files in ``testbenches/`` end that are no test benches."""


def cache_path() -> str:
    """``$DSE_CACHE``, else the user's cache folder; it need not exist yet."""
    named = os.environ.get("DSE_CACHE", "").strip()
    if named:
        return named
    import platformdirs

    return platformdirs.user_cache_dir("dse", appauthor=False)


def workspace_around(path: str) -> str | None:
    """The nearest folder at or above *path* that holds ``components/``, or None. Raises OSError."""
    folder = os.path.realpath(path)
    while not _is_folder(os.path.join(folder, "components")):
        above = os.path.dirname(folder)
        if above == folder:
            return None
        folder = above
    return folder


def _is_folder(path: str) -> bool:
    try:
        return stat.S_ISDIR(os.stat(path).st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return False
