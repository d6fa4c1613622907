"""``dse compare``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import SI, Format, Output, units_word
from dse.cli.terminal import plain, plain_table, print_json, print_line, print_table

if TYPE_CHECKING:
    from dse.api import Compared

Folders = Annotated[
    list[Path], typer.Argument(metavar="DIR DIR…", help="Study folders; each is compared with the first.")
]


@app.command()
def compare(
    folders: Folders,
    form: Format = Output.TABLE,
    si: SI = False,
    designs: Annotated[
        tuple[str, str] | None,
        typer.Option(metavar="A B", help="Compare two designs of one study: runs, or starts of configurations."),
    ] = None,
) -> None:
    """Compare studies: what changed, and which verdicts flipped. Or two designs of one study.

    Runs are the same if they have the same configuration and values of the design variables. Designs are compared case
    by case, in the same draws of the noise. Nothing is simulated.
    """
    if designs is not None:
        _show_designs(folders, designs, form)
        return
    from dse.api import compare as compare_studies, comparison_as_data

    found = compare_studies(folders)
    if form is Output.JSON:
        print_json(comparison_as_data(found, units_word(si)))
        return
    _show_counts(found)
    for study in found[1:]:
        _show_changes(found[0].folder, study)


def _show_counts(comparison: Sequence[Compared]) -> None:
    words = [*dict.fromkeys(word for each in comparison for counts in each.verdicts.values() for word in counts)]
    table = plain_table("study", "runs", "requirement", *words, right=("runs", *words))
    for each in comparison:
        first = (plain(str(each.folder)), f"{each.finished:,} of {each.runs:,}")
        for name, counts in each.verdicts.items() or (("", {}),):
            table.add_row(*first, plain(name), *(f"{counts.get(word, 0):,}" for word in words))
            first = ("", "")
    print_table(table)


def _show_changes(first: Path, study: Compared) -> None:
    from dse.api import flip_counts

    print_line(f"{first} → {study.folder}", style="bold")
    for change in study.changed or ("nothing in the definitions differs",):
        print_line(f"  {change}")
    print_line(
        f"  {study.shared:,} of {study.finished:,} runs are in both; {len(study.flips):,} verdicts on them flipped"
    )
    for (name, was, now), count in flip_counts(study).items():
        print_line(f"  {name}: {was} → {now}, {count:,} run{'s' * (count != 1)}")


def _show_designs(folders: Sequence[Path], designs: tuple[str, str], form: Output) -> None:
    from dse.api import Results
    from dse.cli.decision import decision_as_data, show_decision

    if len(folders) != 1:
        raise typer.BadParameter("name one study folder", param_hint="--designs")
    results = Results(folders[0])
    found = results.against(*designs)
    if form is Output.JSON:
        print_json(decision_as_data(found))
    else:
        show_decision(found, results.definition)
