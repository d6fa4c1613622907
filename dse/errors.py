"""What can be wrong with a user's input, and where."""

from __future__ import annotations

import errno
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True, order=True)
class Location:
    """A place in a file the user wrote; *line* and *column* count from 1, 0 means unknown.

    If the file was written from Python, *argument* is the argument that the place was written from.
    """

    file: str
    line: int = 0
    column: int = 0
    argument: str = field(default="", compare=False)

    def __str__(self) -> str:
        if self.argument:
            return self.argument
        if not self.line:
            return self.file
        return f"{self.file}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class Problem:
    """One error: *what* it is, *where* it is (None: in no file) and a *hint* how to correct it, or ""."""

    what: str
    where: Location | None = None
    hint: str = ""

    def __str__(self) -> str:
        head = f"{self.where}: {self.what}" if self.where else self.what
        return f"{head}\n    hint: {self.hint}" if self.hint else head


class DseError(Exception):
    """The user's input cannot be used; *problems* has every `Problem` found, once each, in file order.

    >>> try:
    ...     dse.open(".").designs["acc_vehicel"]
    ... except dse.DseError as error:
    ...     print(error.problems[0].hint)
    did you mean 'acc_vehicle'?
    """

    def __init__(self, *problems: Problem) -> None:
        super().__init__(*problems)
        once: dict[object, Problem] = {}
        for problem in problems:
            once.setdefault((problem.what, problem.where), problem)
        self.problems = tuple(sorted(once.values(), key=lambda p: _order(p.where)))

    def __str__(self) -> str:
        return "\n".join(str(problem) for problem in self.problems)


def fail(what: str, where: Location | None = None, hint: str = "") -> DseError:
    """A DseError with a single problem, ready to be raised."""
    return DseError(Problem(what, where, hint))


class FreshProcessNeeded(DseError):  # noqa: N818  # says what is wanted; nothing is wrong with the input
    """What was asked for is possible, but not after what this process has done before."""


class Problems(list[Problem]):
    """What is wrong so far, so that all of it is told at once.

    ``with problems:`` ends at a DseError inside, adds its problems, and what stands behind goes on.
    """

    def add(self, what: str, where: Location | None = None, hint: str = "") -> None:
        """One problem more."""
        self.append(Problem(what, where, hint))

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if not isinstance(error, DseError):
            return False
        self += error.problems
        return True


def is_gone(error: OSError) -> bool:
    """Whether *error* states that there is no such file; of any other error the file may be whole."""
    return error.errno in (errno.ENOENT, errno.ENOTDIR, errno.EISDIR)


_REMEDIES = {
    errno.ENOSPC: "make room on the disk; the same command can then be given again",
    getattr(errno, "EDQUOT", -1): "make room in your quota; the same command can then be given again",
    errno.EIO: "the disk or the connection to it may be broken: see the messages of the system (dmesg)",
    errno.EMFILE: "allow more open files ('ulimit -n'), or use fewer workers",
    errno.ENFILE: "the system has too many open files: end other programs",
    errno.ENOMEM: "allow more memory ('ulimit -v'), end other programs, or use fewer workers",
    errno.EAGAIN: "allow more processes ('ulimit -u'), end other programs, or use fewer workers",
}


def remedy(number: int | None, otherwise: str = "") -> str:
    """The hint for an OSError with this *number* that is the machine's and no file's; else *otherwise*."""
    return _REMEDIES.get(number or 0, otherwise)


def raise_if_any(problems: Iterable[Problem]) -> None:
    """Raise one DseError that carries all of *problems*; return if there are none."""
    found = tuple(problems)
    if found:
        raise DseError(*found)


def closest(word: str, words: Iterable[str]) -> str:
    """A hint that names the word meant, or all that are possible."""
    import difflib

    known = sorted(words)
    close = difflib.get_close_matches(word, known, n=1)
    if close:
        return f"did you mean '{close[0]}'?"
    listed = ", ".join(known[:12])
    return f"possible: {listed}{', …' if len(known) > 12 else ''}" if known else ""


def some_of(names: Sequence[str], most: int = 12) -> str:
    """*names* for a message, no more than *most* of them."""
    few = ", ".join(names[:most])
    return few if len(names) <= most else f"{few} and {len(names) - most} more"


def _order(where: Location | None) -> tuple[str, int, int]:
    return (where.file, where.line, where.column) if where else ("", 0, 0)
