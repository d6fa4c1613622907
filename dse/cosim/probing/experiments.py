"""The experiments. Each runs in a process of its own and returns plain data; what it raises is its outcome too.

*drive* is the one the FMU was seen to run with, *expected* what a fresh instance alone in its process did. Where two
instances are in play the other one is driven by other inputs (*other*): equal ones would hide what they share.
"""

from __future__ import annotations

import time
from itertools import islice

from dse.cosim.binding.library import unload
from dse.cosim.probing.excitation import Excitation
from dse.cosim.probing.journal import Journal
from dse.cosim.probing.subject import Row, Subject, Trajectory, difference
from dse.domain.fmu import FmuModel

_PARTS = (0.5, 0.25, 1.0, 0.25)
_MOST_LOADS = 1100


def plain_run(journal: Journal, model: FmuModel, drive: Excitation) -> Trajectory:
    """What a fresh instance does."""
    with Subject(model, journal) as subject:
        return subject.run(drive)


def repeated_run(journal: Journal, model: FmuModel, drive: Excitation, expected: Trajectory) -> str:
    """How a fresh instance in another process differs from *expected*, "" if it does not."""
    with Subject(model, journal) as subject:
        return difference(model, drive, expected, subject.run(drive))


def reset_run(journal: Journal, model: FmuModel, drive: Excitation, other: Excitation, expected: Trajectory) -> str:
    """The same of an instance that ran and was reset."""
    with Subject(model, journal) as subject:
        subject.run(other)
        subject.reset()
        return difference(model, drive, expected, subject.run(drive))


def second_run(journal: Journal, model: FmuModel, drive: Excitation, other: Excitation, expected: Trajectory) -> str:
    """The same of a second instance, made after the first was freed."""
    with Subject(model, journal) as first:
        first.run(other)
    with Subject(model, journal) as second:
        return difference(model, drive, expected, second.run(drive))


def runs_in_turns(
    journal: Journal, model: FmuModel, drive: Excitation, other: Excitation, expected: tuple[Trajectory, Trajectory]
) -> str:
    """The same of two instances that step in turns, the second some steps behind the first."""
    with Subject(model, journal, "first") as first, Subject(model, journal, "second") as second:
        ahead, behind = first.stages(drive), second.stages(other)
        rows: tuple[list[Row], list[Row]] = [next(ahead) for _ in range(1 + drive.steps // 3)], []
        for row in behind:
            rows[1].append(row)
            rows[0].extend(islice(ahead, 1))
        rows[0].extend(ahead)
    return difference(model, drive, expected[0], rows[0]) or difference(model, other, expected[1], rows[1])


def run_from_saved_state(journal: Journal, model: FmuModel, drive: Excitation, expected: Trajectory) -> str:
    """How a run differs after the state halfway was saved, and again after it was restored."""
    with Subject(model, journal) as subject:
        return _from_saved_state(subject, drive, expected, serialized=False)


def run_from_serialized_state(journal: Journal, model: FmuModel, drive: Excitation, expected: Trajectory) -> str:
    """The same where the state was turned into bytes and back."""
    with Subject(model, journal) as subject:
        return _from_saved_state(subject, drive, expected, serialized=True)


def _from_saved_state(subject: Subject, drive: Excitation, expected: Trajectory, *, serialized: bool) -> str:
    half = drive.steps // 2
    subject.initialize(drive)
    rows = [subject.read(0.0), *(subject.step(drive, k) for k in range(half))]
    subject.save()
    onwards = [subject.step(drive, k, may_roll_back=True) for k in range(half, drive.steps)]
    if differs := difference(subject.model, drive, expected, rows + onwards):
        return f"after saving, {differs}"
    if serialized:
        subject.through_bytes()
    subject.restore()
    again = [subject.step(drive, k) for k in range(half, drive.steps)]
    differs = difference(subject.model, drive, expected, rows + again)
    return f"after restoring, {differs}" if differs else ""


def run_in_uneven_steps(journal: Journal, model: FmuModel, drive: Excitation) -> None:
    """Raises if the FMU does not take them."""
    with Subject(model, journal) as subject:
        subject.initialize(drive)
        k = 0.0
        for number in range(drive.steps):
            part = _PARTS[number % len(_PARTS)]
            if k + part > drive.steps:
                break
            subject.write(drive, k)
            subject.advance(drive, k, part)
            k += part
            subject.read(k * drive.step)
        subject.terminate(drive)


def feed_through(journal: Journal, model: FmuModel, drive: Excitation, other: Excitation) -> bool:
    """Whether an output changes when inputs do, between two steps."""
    with Subject(model, journal) as subject:
        subject.initialize(drive)
        for k in range(drive.steps):
            subject.write(drive, k)
            before = subject.read(k * drive.step)
            subject.write(other, k)
            if subject.read(k * drive.step) != before:
                return True
            subject.step(drive, k)
    return False


def load_again_and_again(journal: Journal, model: FmuModel, seconds: float) -> None:
    """Load the library, make an instance, free it, unload the library: as often as *seconds* allow; counted."""
    end = time.monotonic() + seconds
    for number in range(1, _MOST_LOADS + 1):
        with Subject(model, journal) as subject:
            library = subject.library
        journal.note("unloading the library")
        unload(library)
        journal.count(number)
        if time.monotonic() > end:
            return
