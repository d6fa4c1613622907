"""``dse simulate`` again: what it had prepared is kept while nothing it depends on changes; the run is made anew."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dse.cli import answers

if TYPE_CHECKING:
    from dse.api import PreparedRun


def keep_prepared(prepared: PreparedRun, output: str, units: str, *, gate: bool) -> None:
    """Keep *prepared*, and how its run is shown, for the next command with the same arguments."""
    if answers.is_asked():
        content, paths = prepared.packed()
        answers.hand_over(f"{output} {units} {gate}\n".encode() + content, paths)


def simulate_prepared(kept: bytes) -> int:
    """Make and show the run of what was *kept*; the exit code."""
    from dse.processes import import_numpy, mark_command

    mark_command()
    import_numpy()
    from dse.api import unpacked_run
    from dse.cli.runs import exit_code, present_run

    head, _, content = kept.partition(b"\n")
    output, units, gate = head.decode().split()
    run = unpacked_run(content).simulate()
    present_run(run, output, None, units)
    return exit_code(run, gate=gate == "True")
