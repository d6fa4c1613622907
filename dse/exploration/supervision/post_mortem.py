"""What a dead worker left behind: the runs it was in, the place in the simulation, what it printed; all in words."""

from __future__ import annotations

import sys
from dataclasses import dataclass

from dse.exploration.supervision.heartbeat import Phase, State
from dse.exploration.supervision.worker_process import Assignment, WorkerProcess

_LONGEST_LINE = 200


@dataclass(frozen=True, slots=True)
class Traces:
    """*unfinished* are runs of *at_hand* that were begun and had not come back; several in a worker with threads.

    If there are none, *loading* is what was being loaded for, None if nothing was. *progress* and *words* are the
    progress block and the last words of the first thread concerned, *seconds* how long it had been at it.
    """

    states: tuple[State, ...]
    at_hand: Assignment | None
    unfinished: tuple[int, ...]
    loading: Assignment | None
    progress: bytes
    words: str
    seconds: float


def traces_of(worker: WorkerProcess) -> Traces:
    """What is to be known of *worker*; to be asked before it is reaped."""
    states = tuple(worker.states())
    running = {thread: s for thread, s in enumerate(states) if s.phase is Phase.RUNNING}
    at_hand = next((a for a in worker.assignments if any(a.batch.identity == s.batch for s in running.values())), None)
    unfinished = {
        thread: s.number
        for thread, s in running.items()
        if at_hand and s.batch == at_hand.batch.identity and s.number in at_hand.missing
    }
    given = {a.batch.identity: a for a in worker.assignments}
    loading = {
        thread: given[s.batch]
        for thread, s in enumerate(states)
        if not unfinished and s.phase is Phase.LOADING and s.batch in given
    }
    thread = next(iter([*unfinished, *loading]), None)
    return Traces(
        states,
        at_hand,
        tuple(unfinished.values()),
        next(iter(loading.values()), None),
        b"" if thread is None else worker.progress(thread),
        worker.last_words(0 if thread is None else states[thread].printed),
        max(worker.silence().values()),
    )


def told(cause: str, place: str, words: str) -> str:
    """What a worker died of, where, and the last line it printed."""
    said = words.splitlines()[-1].strip()[-_LONGEST_LINE:] if words else ""
    where = f" in {place}" if place and not place.startswith("while") else f" {place}" if place else ""
    return cause + where + (f"; printed last: {said}" if said else "")


def cause_of(code: int) -> str:
    """How a process ended by itself, from its exit code."""
    if code == -9:
        return "killed from outside (signal 9)"
    if code == -31 and sys.platform == "linux":
        return "tried to signal the study (signal 31)"
    if code < 0:
        return f"crashed (signal {-code})"
    # Windows gives the exception that ended a process as a large exit code.
    return f"crashed (exit code {code:#x})" if code > 255 else f"ended by itself (exit code {code})"


def outside_of_runs(traces: Traces) -> str:
    """What a worker was at that died in no run."""
    doing = {Phase.STARTING: "while starting", Phase.WRITING: "while writing waveforms"}
    return next((doing[state.phase] for state in traces.states if state.phase in doing), "between two")
