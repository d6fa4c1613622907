"""Entries of the cache: files and folders under their keys, each with the digest of what was kept beside it.

What is there is compared with its digest when it is used, once per process unless it was touched. What differs is told
and made again; what has no digest, as in earlier versions, counts as absent.
"""

from __future__ import annotations

import os
import shutil
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from enum import Enum
from pathlib import Path

from dse.cache.digests import FOLDER, Stamp, contents, digest_of, stamp
from dse.cache.folder import aside, sync, unreadable, write_file
from dse.errors import DseError, is_gone


class CacheWarning(UserWarning):
    """An entry of the cache has to be made, for it is not what was kept, or takes its time."""


class State(Enum):
    """What is known of an entry."""

    ABSENT = 0
    DAMAGED = 1
    WHOLE = 2


def keep_file(target: Path, make: Callable[[], bytes]) -> Path:
    """The file *target*, made of what *make* gives unless it is there. DseError if the folder cannot be written."""
    return target if _is_whole(target) else put_file(target, make())


def keep_files(target: Path, make: Callable[[], Mapping[str, bytes]]) -> Path:
    """The folder *target*, with the files that *make* gives by their names unless it is there. DseError as above."""
    if _is_whole(target):
        return target
    made = make()

    def fill(folder: Path) -> None:
        for name, content in made.items():
            (folder / name).write_bytes(content)

    return _put_folder(target, fill)


def keep_folder(target: Path, fill: Callable[[Path], None]) -> Path:
    """The folder *target*, filled by *fill* unless it is there. DseError as above, also if *fill* cannot write."""
    return target if _is_whole(target) else _put_folder(target, fill)


def keep_living_folder(target: Path, fill: Callable[[Path], None]) -> Path:
    """As `keep_folder`, but what uses the folder may change it: it is whole if it is there."""
    if not target.is_dir():
        with aside(target.parent) as made:
            (made / "entry").mkdir()
            fill(made / "entry")
            try:
                (made / "entry").replace(target)
            except OSError:
                if not target.is_dir():  # another process was first
                    raise
    return target


def keep_content(target: Path, make: Callable[[], bytes]) -> bytes:
    """What *make* gives or has given, from the file *target* if it is there; kept where that is possible."""
    content = read_entry(target)
    if content is None:
        content = make()
        try_to_put(target, content)
    return content


def read_entry(target: Path) -> bytes | None:
    """What was kept in the file *target*; None if that is not what is there."""
    try:
        return target.read_bytes() if _is_whole(target) else None
    except (OSError, DseError):
        return None


def recent_entries(folder: Path) -> Iterator[bytes]:
    """What was kept in the files in *folder*, what was used last first."""
    digests = sorted(folder.glob(f"*{DIGEST}"), key=lambda file: (-file.stat().st_mtime, file.name))
    found = (read_entry(file.with_name(file.name.removesuffix(DIGEST))) for file in digests)
    return (content for content in found if content is not None)


def put_file(target: Path, content: bytes) -> Path:
    """Keep *content* as *target*, whatever is there. Raises DseError if the folder cannot be written."""
    with aside(target.parent) as made:
        write_file(made / "entry", content)
        _place(made, target)
    return target


def try_to_put(target: Path, content: bytes) -> None:
    """As `put_file`, but for what can as well be made again: it is no error if it cannot be kept."""
    try:
        put_file(target, content)
    except DseError:
        return


def vouch(target: Path) -> None:
    """Give *target* a digest, if an earlier version kept it without and it was found to be right."""
    if state_of(target) is State.ABSENT:
        try:
            try_to_put(target, target.read_bytes())
        except OSError:
            return


def is_damaged(target: Path) -> bool:
    """Whether *target* is not what was kept there."""
    return _reported_state(target) is State.DAMAGED


def state_of(target: Path) -> State:
    """Whether what is at *target* is what was kept there. DseError if it cannot be read."""
    try:
        return _state_read(target)
    except OSError as error:
        raise unreadable(target, error) from error


def _state_read(target: Path) -> State:
    try:
        digest = digest_file(target).read_text(encoding="ascii").strip()
    except ValueError:
        return State.ABSENT
    except OSError as error:
        if not is_gone(error):
            raise
        return State.ABSENT
    if len(digest) != _DIGITS:  # it was being written when the power went
        return State.ABSENT
    key, seen = target.absolute(), stamp(target)
    if _checked.get(key) != (digest, seen):
        if digest_of(contents(target)) != digest:
            return State.DAMAGED
        _checked[key] = digest, seen
    return State.WHOLE


def digest_file(target: Path) -> Path:
    """Where the digest of *target* is kept. It was used last when this file was changed last."""
    return target.with_name(f"{target.name}{DIGEST}")


DIGEST = ".digest"
_DIGITS = 64

_checked: dict[Path, tuple[str, Stamp]] = {}
"""What this process found whole, and how it looked then."""


def touch(file: Path) -> None:
    """Note that *file* is used, to the hour."""
    now = time.time()
    try:
        if not 0 <= now - file.stat().st_mtime < _HOUR:
            os.utime(file, (now, now))
    except OSError:  # not ours to change
        return


_HOUR = 3600


def tell_damage(target: Path) -> None:
    """Say that *target* has to be made again; Python shows the same warning once."""
    state = "damaged" if os.path.lexists(target) else "gone"
    warnings.warn(f"the cache entry {target} is {state} and has to be made again", CacheWarning, stacklevel=2)


def replace_file(target: Path, content: bytes) -> Path:
    """Write *content* to *target* at once, without a digest. Raises DseError if the folder cannot be written."""
    with aside(target.parent) as made:
        write_file(made / "entry", content)
        _move(made / "entry", target)
        sync(target.parent)
    return target


def _is_whole(target: Path) -> bool:
    return _reported_state(target) is State.WHOLE


def _reported_state(target: Path) -> State:
    state = state_of(target)
    if state is State.DAMAGED:
        tell_damage(target)
    elif state is State.WHOLE:
        touch(digest_file(target))
    return state


def _put_folder(target: Path, fill: Callable[[Path], None]) -> Path:
    with aside(target.parent) as made:
        (made / "entry").mkdir()
        fill(made / "entry")
        for name, *_ in stamp(made / "entry"):
            sync(made / "entry" / name)
        _place(made, target)
    return target


def _place(made: Path, target: Path) -> None:
    """Let the entry in *made* stand at *target*, then its digest: what is cut off in between has none."""
    entry = made / "entry"
    write_file(made / "digest", f"{digest_of(contents(entry))}\n".encode())
    digest_file(target).unlink(missing_ok=True)
    _move(entry, target)
    _move(made / "digest", digest_file(target))
    sync(target.parent)


def _move(made: Path, target: Path) -> None:
    """Let *made* become *target*. Nothing is written into what stands there: another process may have it mapped."""
    try:
        made.replace(target)
    except OSError:
        if not os.path.lexists(target):
            raise
        if contents(made) == contents(target):  # another process was first
            return
        if made.is_dir() and target.is_dir() and not target.is_symlink():
            _mend(made, target)
        else:
            remove(target)
            made.replace(target)


def _mend(made: Path, target: Path) -> None:
    """Make the folder *target* hold what *made* does. A file that is right is there at any time, for who uses it."""
    right, there = contents(made), contents(target)
    for name in reversed(there):  # what is in a folder comes before it
        if name not in right or (there[name] == FOLDER) != (right[name] == FOLDER):
            remove(target / name)
    for name, content in right.items():
        if content == FOLDER:
            (target / name).mkdir(exist_ok=True)
        elif there.get(name) != content:
            (made / name).replace(target / name)


def remove(path: Path) -> None:
    """Remove the file or folder *path*, if it is there."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)
