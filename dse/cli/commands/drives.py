"""``dse drives``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Format, Output
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.terminal import console, plain_table, print_json, print_line, print_table

if TYPE_CHECKING:
    from dse.api import Board, CheckedDrive, Score


@app.command("drives")
def drives(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A folder of drives, as 'dse drive' keeps them.")],
    check: Annotated[
        bool, typer.Option("--check", help="Simulate every drive again, and compare the results bit for bit.")
    ] = False,
    output: Format = Output.TABLE,
) -> None:
    """Rank the drivers on each bench, and show the results of the design without a driver.

    New drives are added as runs: DIR/BENCH is a study, with the driver as a condition, for 'dse report', 'dse figure'
    and other commands. Recordings are not changed.
    """
    from dse.api import Drives

    kept = Drives(folder)
    with console(stderr=True).status("") as status:
        kept.update(tell=status.update)
        problems = list(kept.problems)
        checked = list(kept.check(tell=status.update)) if check else []
    problems = list(dict.fromkeys((*problems, *kept.problems)))
    for problem in problems:
        print_line(str(problem), stderr=True)
    boards = kept.boards()
    if output is Output.JSON:
        data = {"boards": [board.data() for board in boards], "problems": [str(problem) for problem in problems]}
        print_json(data | ({"checked": [_checked_data(each) for each in checked]} if check else {}))
    else:
        _show(boards, checked)
    raise typer.Exit(DONE if all(each.is_same for each in checked) else RUNS_FAILED)


def _show(boards: tuple[Board, ...], checked: list[CheckedDrive]) -> None:
    from dse.api import SCORING

    if not boards:
        print_line("there is no drive yet")
    for board in boards:
        print_line(f"{board.bench}  ({board.folder})")
        table = plain_table("", "driver", "drive", "configuration", "met", "worst margin", "time", "", right=("met",))
        for score in board.scores:
            table.add_row(*_row(score))
        print_table(table)
    if boards:
        print_line(SCORING)
    for each in checked:
        print_line(f"{each.id} of {each.driver} on {each.bench}: {_checked_text(each)}")


def _row(score: Score) -> tuple[str, ...]:
    from rich.markup import escape

    share = f"{100 * score.worst:+.0f} % ({score.worst_requirement})" if score.worst_requirement else "–"
    late = f"{score.overruns} of {score.steps} steps late" if score.overruns else ""
    place = f"{score.place}." if score.place else ""
    who = "controller" if score.is_controller else escape(score.driver)
    beside = "; ".join(filter(None, (score.note, late)))
    name = "–" if score.is_controller else score.drive
    return place, who, name, score.configuration, f"{score.met} of {score.of}", share, f"{score.seconds:g} s", beside


def _checked_text(checked: CheckedDrive) -> str:
    if not checked.is_same:
        parts = [f"in the study: {', '.join(checked.from_study)}"] if checked.from_study else []
        parts += [f"when it was driven: {', '.join(checked.from_driving)}"] if checked.from_driving else []
        return f"not the same as {'; '.join(parts)}"
    return "the same bit for bit" + (
        "" if checked.was_noted else ", as far as the study: there is no record of the drive"
    )


def _checked_data(checked: CheckedDrive) -> dict[str, object]:
    return {
        "drive": checked.id,
        "bench": checked.bench,
        "driver": checked.driver,
        "is_same": checked.is_same,
        "from_study": list(checked.from_study),
        "from_driving": list(checked.from_driving),
        "was_noted": checked.was_noted,
    }
