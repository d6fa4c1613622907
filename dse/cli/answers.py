"""Answers that commands gave before, printed again while nothing they depend on has changed.

A command that only reads a workspace gives the same answer until one of these changes: the version and code of dse, the
arguments, the environment, the terminal, a file of the workspace, a file that it names elsewhere, a compiler, or what
the cache holds about FMUs. All of them but the files are in the name of an answer; of the files it has a stamp.
So the second ``dse check`` reads the times of the files and prints what the first one found::

    key = digest(version, arguments, environment, …)            answers/<key>: stamp of the files, then the output
    stamp(files) == stamp in answers/<key>                      print it; else run the command, and keep what it prints

A stamp has size, times, number and mode of each file. On POSIX this is enough, as no program can set back the time at
which a file changed; elsewhere no answer is kept. The stamp is taken before and after a command, and must be the same
and two seconds old: no answer is kept for files that changed while it was found, or so recently that a clock could miss
the next change. Only answers without errors, notes and warnings are kept, and none where ``DSE_ANSWERS=0``.

``dse simulate`` simulates each time. Of it is kept what it had prepared for its run, which names the FMUs in the cache.

This module runs before anything else of a command, so it imports next to nothing. Costs: `docs/decisions/0037`.
"""

from __future__ import annotations

import os
import sys

from dse import __version__
from dse.cli import streams
from dse.places import OUT, cache_path, workspace_around

_COMMANDS = {("check",), ("components",), ("enumerate",), ("list",)} | {
    ("space", name) for name in ("best", "choices", "compare", "conflict", "constraints", "count", "explain", "pareto")
}
_WRITES = ("-o", "--output", "-i", "--interactive")
_HELP = ("-h", "--help")
_PASSING = frozenset({"_", "OLDPWD", "PWD", "SHLVL", "WINDOWID"})
"""Parts of the environment that change from command to command and mean nothing to one."""
_TOOLS = ("cc", "gcc", "clang", "omc", "wine", "sumo")
_KNOWN = ("facts", "numerics", "trusted", "compilers")
"""Folders of the cache that say what is known of FMUs and workspaces."""
FOLDER = "answers"
"""Where answers are in the cache."""
_MOST_FILES = 20_000
_SETTLED = 2_000_000_000
"""Nanoseconds after which a file that changes has other times than before."""
_KEPT = 500


class _Command:
    """The command at hand: what is to be kept of it, and what was *found* that it prepared before.

    It has *handed* over what is kept in place of its output, and the files that are named in that.
    """

    def __init__(self) -> None:
        self.question: _Question | None = None
        self.found: bytes | None = None
        self.handed: tuple[bytes, frozenset[str]] = b"", frozenset()


_command = _Command()


class _UnfitError(Exception):
    """This command, or what it depends on, is not of the kind whose answers are kept."""


class _Question:
    def __init__(self, arguments: list[str]) -> None:
        is_help = any(each in arguments for each in _HELP)
        self.is_answer = is_help or _is_reading(arguments)
        is_fit = self.is_answer or arguments[:1] == ["simulate"]
        if os.name != "posix" or os.environ.get("DSE_ANSWERS") == "0" or not is_fit:
            raise _UnfitError
        self.roots = () if is_help else _roots(arguments)
        self.has_results = arguments[0] == "list"
        folder = cache_path()
        self.file = os.path.join(folder, FOLDER, _digest(*_circumstances(arguments, folder)))
        self.stamp, self.newest = "", 0

    def look(self, named: tuple[str, ...]) -> None:
        """Stamp the workspace and what it has *named* elsewhere."""
        lines, self.newest = _stamps((*self.roots, *named), has_results=self.has_results)
        self.stamp = _digest(*lines)


def answer(arguments: list[str]) -> bool:
    """Print what the command with *arguments* printed before, if that still holds; else have its output recorded.

    What it prepared before is `found_prepared`, if that still holds.
    """
    vars(_command).update(vars(_Command()))
    try:
        question = _Question(arguments)
        found = _read(question.file)
        if found is not None:
            stamp, named, output = found
            question.look(named)
            if question.stamp == stamp and not question.is_answer:
                _command.found = output
                _touch(question.file)
                return False
            if question.stamp == stamp:
                sys.stdout.buffer.write(output)
                sys.stdout.buffer.flush()
                _touch(question.file)
                return True
        question.look(())
    except (_UnfitError, OSError, ValueError, streams.OutputError):
        return False
    _command.question, streams.record.content = question, bytearray() if question.is_answer else None
    return False


def found_prepared() -> bytes | None:
    """What a command with the same arguments handed over, if nothing that it depends on has changed."""
    return _command.found


def is_asked() -> bool:
    """Whether what the command prepared can be kept."""
    return _command.question is not None and not _command.question.is_answer


def hand_over(content: bytes, paths: frozenset[str]) -> None:
    """Keep *content*, in which *paths* are named, if the command ends without an error."""
    _command.handed = content, paths


def keep() -> None:
    """Keep what the command has printed or handed over; it ended without an error."""
    question, (handed, paths) = _command.question, _command.handed
    output, streams.record.content = handed or streams.record.content, None
    if question is None or not output or streams.record.has_notes:
        return
    try:
        if question.roots and _has_plugins():
            return
        before = question.stamp
        question.look(())
        if question.stamp != before:
            return
        named = _named_elsewhere(question.roots, paths)
        question.look(named)
        if question.roots and question.newest + _SETTLED > _now():
            return
        _write(question.file, question.stamp, named, bytes(output))
    except (_UnfitError, OSError):
        return


def _is_reading(arguments: list[str]) -> bool:
    if any(each.startswith(_WRITES) for each in arguments):
        return False
    return tuple(arguments[:1]) in _COMMANDS or tuple(arguments[:2]) in _COMMANDS


def _roots(arguments: list[str]) -> tuple[str, ...]:
    """The workspaces of the current folder and of each argument that is a path."""
    places = [os.getcwd(), *(each for each in arguments if os.path.lexists(each))]
    found = [workspace_around(place) for place in places]
    if None in found:
        raise _UnfitError
    return tuple(dict.fromkeys(filter(None, found)))


def _circumstances(arguments: list[str], cache: str) -> list[str]:
    """All that an answer depends on but the files of its workspace."""
    from shutil import get_terminal_size, which

    width = str(get_terminal_size()) if sys.stdout.isatty() else ""
    around = [f"{name}={value}" for name, value in sorted(os.environ.items()) if name not in _PASSING]
    tools = [found for name in (os.environ.get("CC") or "cc", *_TOOLS) if (found := which(name))]
    places = [*sys.path, *tools, *(os.path.join(cache, name) for name in _KNOWN)]
    stats = [f"{place}{_times(place)}" for place in places]
    return [__version__, sys.version, sys.executable, os.getcwd(), *arguments, "", width, *around, *stats, *_code()]


def _code() -> list[str]:
    """The stamp of dse itself: of every file of a source tree, else of the one file that each installation writes."""
    own = os.path.dirname(os.path.dirname(__file__))
    if os.path.lexists(os.path.join(os.path.dirname(own), "pyproject.toml")):
        return _stamps((own,))[0]
    return [_times(os.path.join(own, "__init__.py"))]


def _times(place: str) -> str:
    try:
        found = os.stat(place)
    except OSError:
        return ""
    return _shown(found)


def _shown(found: os.stat_result) -> str:
    return f" {found.st_size} {found.st_mtime_ns} {found.st_ctime_ns} {found.st_ino}"


def _stamps(places: tuple[str, ...], *, has_results: bool = False) -> tuple[list[str], int]:
    """A line for each file at or below *places*, and when the newest of them changed (ns since 1970)."""
    lines: list[str] = []
    newest = 0
    pending = [*reversed(places)]
    while pending:
        place = pending.pop()
        if not os.path.isdir(place):
            state = os.stat(place)
            newest = max(newest, state.st_mtime_ns, state.st_ctime_ns)
            lines.append(f"{place}{_shown(state)}")
            continue
        lines.append(place)
        with os.scandir(place) as found:
            entries = sorted(found, key=lambda entry: entry.name)
        for entry in entries:
            is_link = entry.is_symlink()
            if entry.is_dir():
                if is_link:  # it may lead anywhere
                    raise _UnfitError
                if not _is_passed_over(entry.name) or (has_results and entry.name == OUT):
                    pending.append(entry.path)
                continue
            state = entry.stat(follow_symlinks=is_link)
            newest = max(newest, state.st_mtime_ns, state.st_ctime_ns)
            lines.append(f"{entry.path} {state.st_mode}{_shown(state)}")
        if len(lines) > _MOST_FILES:
            raise _UnfitError
    return lines, newest


def _is_passed_over(name: str) -> bool:
    """What a workspace has beside its files; what these name in it is stamped by itself."""
    return name.startswith(".") or name in (OUT, "node_modules", "__pycache__")


def _named_elsewhere(roots: tuple[str, ...], paths: frozenset[str]) -> tuple[str, ...]:
    """What files of the workspace named, and *paths*, which their stamp passes over or which lie elsewhere."""
    loaded = sys.modules.get("dse.loading.paths")
    named = sorted({*map(str, loaded.FOLLOWED if loaded else ()), *paths})
    return tuple(name for name in named if not any(_is_stamped(name, root) for root in roots))


def _is_stamped(name: str, root: str) -> bool:
    if not name.startswith(root + "/"):
        return False
    return not any(map(_is_passed_over, name[len(root) + 1 :].split("/")[:-1]))


def _has_plugins() -> bool:
    """Whether another package adds to dse: its code has no stamp."""
    from importlib.metadata import entry_points

    return any(group.startswith("dse.") for group in entry_points().groups)


def _digest(*parts: str) -> str:
    return _digest_of("\0".join(parts).encode(errors="surrogateescape"))


def _digest_of(content: bytes) -> str:
    from hashlib import blake2b

    return blake2b(content, digest_size=16).hexdigest()


def _read(file: str) -> tuple[str, tuple[str, ...], bytes] | None:
    """The stamp, the paths and the output in *file*, as `dse.cache.keep` wrote them; None if it is not there."""
    try:
        with open(file, "rb") as opened:
            whole = opened.read()
    except FileNotFoundError:
        return None
    head, _, content = whole.partition(b"\n")
    if head.decode("ascii", "replace") != f"{os.path.basename(file)} {_digest_of(content)}":
        _report_damage(file)
        return None
    first, _, output = content.partition(b"\n")
    stamp, *named = first.decode("utf-8", "surrogateescape").split("\0")
    return stamp, tuple(named), output


def _report_damage(file: str) -> None:
    from pathlib import Path

    from dse.cache import tell_damage

    tell_damage(Path(file))
    os.unlink(file)


def _write(file: str, stamp: str, named: tuple[str, ...], output: bytes) -> None:
    if any("\n" in name for name in named):
        return
    from pathlib import Path

    from dse.cache import keep as keep_plain

    first = "\0".join((stamp, *named)).encode("utf-8", "surrogateescape")
    keep_plain(Path(file), os.path.basename(file), first + b"\n" + output, _KEPT)


def _touch(file: str) -> None:
    from contextlib import suppress

    with suppress(OSError):
        os.utime(file)


def _now() -> int:
    import time

    return time.time_ns()
