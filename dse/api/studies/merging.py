"""Study folders of shards become one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from dse.errors import Location, fail
from dse.storage import Merged, merge_studies, shards_in

__all__ = ["Merged", "merge_into"]


def merge_into(folders: Sequence[Path], target: Path | None = None) -> tuple[Path, Merged]:
    """Merge *folders*, or the shards in them, into *target*; without, into the one folder given. Returns it, too.

    DseError if there are no shards, or they are not of one study.
    """
    if target is None and len(folders) > 1:
        raise fail("several folders are to be merged", hint="name the target: dse merge -o OUT …")
    sources = [source for folder in folders for source in (shards_in(folder) or [folder])]
    if sources == [target or folders[0]]:
        what, hint = "contains no shards", "dse explore STUDY --shard 1/8 creates one, in out/STUDY"
        raise fail(what, Location(str(folders[0])), hint)
    return target or folders[0], merge_studies(target or folders[0], sources)
