"""``dse enumerate``."""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from enum import StrEnum
from itertools import islice
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app, console, print_json, print_table
from dse.cli.arguments import Design, workspace_of

if TYPE_CHECKING:
    from dse.domain.design import Configuration, DesignSpace


class Listing(StrEnum):
    """How configurations are listed."""

    TABLE = "table"
    JSON = "json"
    CSV = "csv"


@app.command("enumerate")
def enumerate_(
    design: Design,
    count: Annotated[bool, typer.Option("--count", help="Only how many there are.")] = False,
    output: Annotated[
        Listing, typer.Option("--format", help="For a person, a program or a spreadsheet.")
    ] = Listing.TABLE,
    limit: Annotated[int | None, typer.Option("--limit", "-n", min=1, help="List only the first N.")] = None,
) -> None:
    """List or count the valid configurations.

    Valid are those that meet every static constraint of the design space.
    """
    from dse.errors import DseError
    from dse.space.check import check
    from dse.space.enumerate import configurations

    space = workspace_of(design).design(design)
    problems = check(space)
    if problems:
        raise DseError(*problems)
    if count:
        _count(space, output)
        return
    found = islice(configurations(space), limit)
    if output is Listing.JSON:
        from dse.testbench.definition import describe_configuration

        print_json([describe_configuration(c, space) for c in found])
    elif output is Listing.CSV:
        _csv(space, found)
    else:
        _table(space, list(found), limit)


def _count(space: DesignSpace, output: Listing) -> None:
    from dse.space.enumerate import count, total

    numbers = {"design": space.name, "total": total(space), "valid": count(space)}
    if output is Listing.JSON:
        print_json(numbers)
    elif output is Listing.CSV:
        csv.writer(sys.stdout, lineterminator="\n").writerows([numbers.keys(), numbers.values()])
    else:
        console().print(f"{space.name}: {numbers['valid']} of {numbers['total']} configurations are valid")


def _csv(space: DesignSpace, found: Iterator[Configuration]) -> None:
    from dse.testbench.definition import places

    columns = places(space)
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["id", *columns])
    for configuration in found:
        writer.writerow([configuration.id, *(configuration.choices.get(place, "") for place in columns)])


def _table(space: DesignSpace, found: list[Configuration], limit: int | None) -> None:
    from rich.table import Table

    from dse.space.enumerate import total
    from dse.testbench.definition import describe_configuration, places, summed_properties

    described = [describe_configuration(configuration, space) for configuration in found]
    shared = summed_properties(space)
    columns = places(space)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("id", *columns):
        table.add_column(heading, no_wrap=True)
    for heading in shared:
        table.add_column(heading, justify="right", no_wrap=True)
    for data in described:
        totals = [data["totals"].get(name) for name in shared]
        table.add_row(
            data["id"],
            *(data["choices"].get(place, "–") for place in columns),
            *(f"{t['value']:g} {t['unit']}" if t else "–" for t in totals),
        )
    print_table(table)
    screen = console()
    if limit is not None and len(found) == limit:
        screen.print(f"the first {limit}; {total(space)} in total before the static constraints")
    else:
        screen.print(f"{len(found)} of {total(space)} configurations are valid")
