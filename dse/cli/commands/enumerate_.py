"""``dse enumerate``."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.api.naming import space_of
from dse.api.spaces.question import ask
from dse.cli.app import app
from dse.cli.arguments import Design, Off, On, Seed, Where
from dse.cli.terminal import console, plain_table, print_json, print_table, say

if TYPE_CHECKING:
    from dse.domain.design import DesignSpace
    from dse.space.engine import Engine
    from dse.space.flat import Rows
    from dse.space.output.sheet import Sheet


class Listing(StrEnum):
    """How configurations are listed."""

    TABLE = "table"
    CSV = "csv"
    JSON = "json"
    JSON_LINES = "jsonl"
    PARQUET = "parquet"


SHOWN = 100
"""Rows of a table where no limit is given; files and streams are complete."""


@app.command("enumerate")
def enumerate_(
    design: Design,
    count: Annotated[bool, typer.Option("--count", help="Only how many there are.")] = False,
    exact: Annotated[bool, typer.Option("--exact", help="With --count: no estimate, however long it takes.")] = False,
    output: Annotated[
        Listing, typer.Option("--format", help="For a person, a spreadsheet or a program.")
    ] = Listing.TABLE,
    target: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Write a .csv, .json, .jsonl or .parquet file."),
    ] = None,
    limit: Annotated[int | None, typer.Option("--limit", "-n", min=1, help="List only the first N.")] = None,
    sample: Annotated[int | None, typer.Option("--sample", min=1, help="Draw N at random, each as likely.")] = None,
    seed: Seed = 0,
    where: Where = None,
    on: On = [],
    off: Off = [],
    interactive: Annotated[bool, typer.Option("--interactive", "-i", help="Choose step by step, with counts.")] = False,
) -> None:
    """List, count or draw the valid configurations.

    Valid are those that meet every static constraint of the design space.

    A table shows the first 100 unless --limit says otherwise; CSV, JSON and files hold all.
    """
    from dse.api.spaces.design import first_rows
    from dse.space.output.sheet import Sheet

    if exact and not count:
        raise typer.BadParameter("goes with --count", param_hint="--exact")
    if sample is not None and limit is not None:
        raise typer.BadParameter("one of --sample and --limit", param_hint="--sample")
    if count and interactive:
        raise typer.BadParameter("one of --count and --interactive", param_hint="--count")
    listing = {"--output": target, "--sample": sample, "--limit": limit}
    for option, given in listing.items():
        if count and given is not None:
            raise typer.BadParameter("lists configurations; --count only says how many", param_hint=option)
    if target is not None and output is not Listing.TABLE and target.suffix.lower() != f".{output.value}":
        raise typer.BadParameter(f"'{target.name}' is not the name of a .{output.value} file", param_hint="--format")
    question = ask(space_of(design), (), where, on, off)
    space, engine = question.space, question.engine
    if interactive:
        from dse.cli.picking.interactive import choose

        choose(space, engine, target)
    elif count:
        _count(space, engine, seed, output, where, exact=exact)
    elif target is not None:
        _save(Sheet(space), _drawn(engine, sample, seed) if sample else first_rows(engine.blocks(), limit), target)
    elif output is not Listing.TABLE:
        _stream(Sheet(space), _drawn(engine, sample, seed) if sample else first_rows(engine.blocks(), limit), output)
    elif sample is not None:
        (rows,) = _drawn(engine, sample, seed)
        _table(Sheet(space), rows)
        console().print(f"{len(rows)} drawn, each valid configuration as likely as any other")
    else:
        _first(space, engine, limit or SHOWN, limit is None, where)


def _count(space: DesignSpace, engine: Engine, seed: int, output: Listing, where: str | None, *, exact: bool) -> None:
    from dse.cli.spaces import tally_data, tally_text
    from dse.space.enumerate import total
    from dse.space.tally import Tally

    tally = Tally(engine.exactly()) if exact else engine.count(seed)
    numbers = {"design": space.name, "total": total(space), **tally_data(tally)}
    if where:
        numbers["where"] = where
    if output in (Listing.JSON, Listing.JSON_LINES):
        print_json(numbers)
    elif output is Listing.CSV:
        import csv

        csv.writer(sys.stdout, lineterminator="\n").writerows(
            # As in JSON: true, and nothing for null.
            [numbers.keys(), [str(value).lower() if isinstance(value, bool) else value for value in numbers.values()]]
        )
    elif output is Listing.PARQUET:
        raise typer.BadParameter("a count is one number: table, csv or json", param_hint="--format")
    else:
        said = _are_valid(tally_text(tally), numbers["total"], where)
        say(f"{space.name}: {said}")


def _are_valid(valid: str, total: int, where: str | None) -> str:
    """``2 of 135 configurations are valid``; under a condition that says too little."""
    from dse.cli.spaces import number_text

    verb, also = ("is", "meets") if valid == "1" else ("are", "meet")
    if where:
        return f"{valid} of {number_text(total)} combinations {verb} valid and {also} the condition"
    return f"{valid} of {number_text(total)} configuration{'' if total == 1 else 's'} {verb} valid"


def _save(sheet: Sheet, blocks: Iterable[Rows], target: Path) -> None:
    from dse.space.output.export import save

    written = save(sheet, blocks, target)
    say(f"{target}: {written:,} configuration{'' if written == 1 else 's'}")


def _stream(sheet: Sheet, blocks: Iterable[Rows], output: Listing) -> None:
    from dse.space.output.export import WRITERS

    if output is Listing.PARQUET and sys.stdout.isatty():
        raise typer.BadParameter("parquet is no text: name a file with -o", param_hint="--format")
    WRITERS[output.value](sheet, blocks, sys.stdout.buffer)


def _first(space: DesignSpace, engine: Engine, most: int, cut: bool, where: str | None) -> None:
    from dse.cli.spaces import number_text
    from dse.space.enumerate import total
    from dse.space.output.sheet import Sheet

    rows = engine.rows(most + 1)
    more = len(rows) > most
    _table(Sheet(space), rows[:most])
    every = total(space)
    if not more:
        say(_are_valid(f"{len(rows):,}", every, where))
        return
    before = "the static constraints and the condition" if where else "the static constraints"
    say(f"the first {most}; {number_text(every)} in total before {before}")
    if cut:
        say("more: --limit N shows N, -o FILE writes all, --count says how many")


def _table(sheet: Sheet, rows: Rows) -> None:
    import math

    table = plain_table("id", *(place.path for place in sheet.places))
    for total in sheet.totals:
        table.add_column(total.name, justify="right")
    columns = [sheet.ids(rows)]
    columns += [[place.names[code] if code >= 0 else "–" for code in place.of(rows).tolist()] for place in sheet.places]
    for total in sheet.totals:
        unit = total.unit.symbol
        columns.append(["–" if math.isnan(v) else f"{v:g} {unit}".rstrip() for v in total.values(rows).tolist()])
    for cells in zip(*columns, strict=True):
        table.add_row(*cells)
    print_table(table)


def _drawn(engine: Engine, number: int, seed: int) -> tuple[Rows]:
    return (engine.sample(number, seed),)
