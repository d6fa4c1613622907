"""``dse space offer``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import Dealership, opened
from dse.cli.arguments import Choose, Design, Format, Output
from dse.cli.commands.space import space_app
from dse.cli.spaces import number_text
from dse.cli.terminal import plain_table, print_json, print_line, print_table

if TYPE_CHECKING:
    from dse.space import ChoicePoint, Offer, OfferedChoice

_RULED_OUT = 3


@space_app.command("offer")
def space_offer(
    design: Design,
    choose: Choose = [],
    cheapest: Annotated[bool, typer.Option("--cheapest", help="Choose the rest so that sum(cost) is least.")] = False,
    surprise: Annotated[
        int | None,
        typer.Option("--surprise", metavar="SEED", min=0, help="Draw the rest at random, all equally likely."),
    ] = None,
    output: Format = Output.TABLE,
) -> None:
    """Configure step by step, as at a car dealership: what is still possible, and why the rest is not.

    Shows what each choice would exclude elsewhere, which choices follow from others, and which sums of properties are
    still possible; all exact. The dealership of the drive page shows the same.
    """
    if cheapest and surprise is not None:
        raise typer.BadParameter("one of --cheapest and --surprise", param_hint="--surprise")
    part = opened(design, choose)
    dealership = Dealership(part.space)
    chosen = dict(part.chosen)
    if cheapest:
        chosen = dealership.cheapest(chosen)
    elif surprise is not None:
        chosen = dealership.surprise(chosen, surprise)
    offer = dealership.offer(chosen)
    if output is Output.JSON:
        print_json(offer.data())
        return
    _show(offer)


def _show(offer: Offer) -> None:
    print_line(f"{offer.title}: {number_text(offer.left)} of {number_text(offer.total)} configurations left")
    if not offer.left:
        print_line("nothing has all that is chosen: " + "; ".join(offer.texts()))
    for total in offer.totals:
        ends = f"{total.low:.6g}" if total.low == total.high else f"{total.low:.6g} … {total.high:.6g}"
        print_line(f"  {total.title}: {ends} {total.unit}".rstrip())
    table = plain_table("place", "", "choice", "")
    for point in offer.points:
        for number, choice in enumerate(point.choices):
            table.add_row(
                point.path if not number else "", _mark(point, choice), choice.name, _choice_text(point, choice)
            )
    if offer.points:
        print_table(table)
    if offer.configuration:
        print_line(f"configuration {offer.configuration}")


def _mark(point: ChoicePoint, choice: OfferedChoice) -> str:
    if point.chosen == choice.name:
        return "●"
    if point.implied == choice.name:
        return "○"
    return "" if choice.is_possible else "✗"


def _choice_text(point: ChoicePoint, choice: OfferedChoice) -> str:
    if not choice.is_possible:
        return "; ".join(choice.texts())
    if point.implied == choice.name:
        return "follows"
    gone = [f"{path}={name}" for path, name in choice.rules_out]
    more = f" and {len(gone) - _RULED_OUT} more" if len(gone) > _RULED_OUT else ""
    return f"rules out {', '.join(gone[:_RULED_OUT])}{more}" if gone else ""
