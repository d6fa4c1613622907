"""What a shell offers for an argument: names of the workspace around the current folder, by its files alone."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from dse.places import NO_BENCHES, PROCEDURE, RATING, STUDY


def words() -> list[str]:
    """What was typed after the program's name, where a shell asks what could come next."""
    line = os.environ.get("_TYPER_COMPLETE_ARGS") or os.environ.get("COMP_WORDS", "")
    return line.split()[1:]


def designs(incomplete: str) -> list[str]:
    """Design spaces."""
    return _matching(incomplete, (path.stem for path in _files("designs")))


def benches(incomplete: str) -> list[str]:
    """Test benches."""
    return _matching(incomplete, (path.stem for path in _files("testbenches") if not path.name.endswith(NO_BENCHES)))


def studies(incomplete: str) -> list[str]:
    """Studies."""
    names = (path.name for path in _files("testbenches"))
    return _matching(incomplete, (name.removesuffix(STUDY) for name in names if name.endswith(STUDY)))


def ratings(incomplete: str) -> list[str]:
    """Ratings."""
    names = (path.name for path in _files("testbenches"))
    return _matching(incomplete, (name.removesuffix(RATING) for name in names if name.endswith(RATING)))


def procedures(incomplete: str) -> list[str]:
    """Test procedures."""
    names = (path.name for path in _files("testbenches"))
    return _matching(incomplete, (name.removesuffix(PROCEDURE) for name in names if name.endswith(PROCEDURE)))


def roads(incomplete: str) -> list[str]:
    """Roads."""
    return _matching(incomplete, (path.stem for path in _files("roads")))


def folders_and_roads(incomplete: str) -> list[str]:
    """What can be drawn: folders of `folders`, and roads."""
    return sorted({*folders(incomplete), *roads(incomplete)})


def components(incomplete: str) -> list[str]:
    """Components that have a file of their own."""
    return _matching(incomplete, (path.parent.name for path in _files("components") if path.name == "component.yaml"))


def folders(incomplete: str) -> list[str]:
    """Folders in the workspace's ``out/``, by their names; a shell offers other folders itself if none fits."""
    from dse.loading import find_root
    from dse.places import OUT

    root = find_root(Path())
    place = root / OUT if root else None
    found = sorted(place.iterdir()) if place and place.is_dir() else []
    return _matching(incomplete, (path.name for path in found if path.is_dir()))


def pages(incomplete: str) -> list[str]:
    """Pages of ``dse docs``."""
    from dse.shipped import content

    folder = content("docs") / "docs"
    return _matching(incomplete, (path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.md")))


def kinds_of_files(incomplete: str) -> list[str]:
    """Kinds of files that there is a schema of."""
    from dse.shipped import content

    return _matching(incomplete, (path.stem for path in (content("schemas") / "schemas").glob("*.json")))


def _files(folder: str) -> Iterable[Path]:
    from dse.loading import Workspace, find_root

    root = find_root(Path())
    return Workspace(root).files(folder) if root else ()


def _matching(incomplete: str, names: Iterable[str]) -> list[str]:
    return sorted({name for name in names if name.startswith(incomplete)})
