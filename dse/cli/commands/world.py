"""``dse world``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import workspace_of
from dse.cli.app import app
from dse.cli.arguments import Bench, Configuration, FmiVersion, Parts, Settings, split_parts
from dse.cli.commands.simulate import read_settings
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.terminal import plain_table, print_line, print_table

if TYPE_CHECKING:
    from dse.api import WorldLayout
    from dse.domain.component import Type
    from dse.live import News

Port = Annotated[int, typer.Option("--port", min=1, max=65535, help="The UDP port.")]
Listen = Annotated[
    str,
    typer.Option("--listen", metavar="ADDRESS", help="Listen on this address; every client that reaches it is served."),
]
Answers = Annotated[
    str | None,
    typer.Option(
        "--answers", metavar="HOST:PORT", help="Send answers there, for a client that receives at another port."
    ),
]
Once = Annotated[bool, typer.Option("--once", help="End after one session: with 3 if it failed.")]
Free = Annotated[bool, typer.Option("--free", help="Real time by the wall clock, instead of lockstep.")]
Layout = Annotated[bool, typer.Option("--layout", help="Only print the layout of the packets, byte by byte.")]
Write = Annotated[
    Path | None, typer.Option("--write", metavar="DIR", help="Only write a component.yaml that represents this world.")
]


@app.command()
def world(
    bench: Bench,
    configuration: Configuration = None,
    parts: Parts = None,
    settings: Settings = [],
    port: Port = 5005,
    listen: Listen = "127.0.0.1",
    answers: Answers = None,
    once: Once = False,
    free: Free = False,
    layout: Layout = False,
    write: Write = None,
    version: FmiVersion = 2,
) -> None:
    """Simulate the world's half of a bench, for a car that is simulated elsewhere.

    The car's half is simulated by 'dse simulate BENCH --world HOST:PORT', also by 'dse run' or 'dse explore', on this
    machine or another one. Results are bit-identical to those of the whole bench. Serves one session after another,
    each a separate run, until Ctrl-C.

    With --layout or --write nothing is simulated: they are for external worlds (Unity, Unreal, Godot).
    """
    from dse.api import serve_bench, world_at, world_layout, write_world

    tested, given = workspace_of(bench).bench(bench), read_settings(settings)
    if layout or write is not None:
        told = world_layout(tested, configuration, given, world_at(f"127.0.0.1:{port}", split_parts(parts)))
        if layout:
            _show(told)
        if write is not None:
            for path in write_world(told, write):
                print_line(str(path))
        return
    news = serve_bench(
        tested,
        configuration,
        given,
        port=port,
        listen=listen,
        answers=answers,
        parts=split_parts(parts),
        free=free,
        fmi=version,
    )
    there = world_layout(tested, configuration, given, world_at(f"127.0.0.1:{port}", split_parts(parts)))
    print_line(f"world of {tested.name}: {', '.join(there.parts)}; configuration {there.configuration}", style="bold")
    back = f", answers to {answers}" if answers else ""
    print_line(f"listening at {listen}:{port}{back}; Ctrl-C ends it", stderr=True)
    for one in news:
        print_line(_line(one), style="red" if one.is_failed else None)
        if once and one.is_over:
            raise typer.Exit(RUNS_FAILED if one.is_failed else DONE)


def _line(news: News) -> str:
    at = f"session {news.session}: "
    if news.is_failed:
        return f"{at}failed at {news.time:g} s: {news.why}"
    if not news.steps:
        return f"{at}connected"
    more = f"; {news.why}" if news.why else ""
    end = "ended after " if news.is_over else ""
    rate = f", {news.rate:,.0f} in a second" if news.rate else ""
    return f"{at}{end}{news.time:g} s, {news.steps} exchanges{rate}{more}"


def _show(told: WorldLayout) -> None:
    print_line(f"world: {', '.join(told.parts)}; configuration {told.configuration}", style="bold")
    print_line("all numbers little-endian; Booleans are 0 or 1, items of an enumeration their number")
    for title, values in (("to the world", told.to_world), ("back to the car", told.to_car)):
        _show_packet(title, values, told.number)


def _show_packet(title: str, values: tuple[tuple[str, Type], ...], number: int) -> None:
    from dse.api import HEAD_BYTES, VALUE_BYTES

    tail = HEAD_BYTES + VALUE_BYTES * len(values)
    print_line("")
    print_line(f"{title}: {tail + 4} bytes", style="bold")
    table = plain_table("offset", "bytes", "number", "type", right=("offset",))
    for offset, name in enumerate(("magic and version, 0x44534531", "session", "sequence", "flags")):
        table.add_row(str(4 * offset), "int32", name, "")
    table.add_row("16", "float64", "time", "s")
    for place, (name, type_) in enumerate(values):
        what = f"always {number}" if place == len(values) - 1 else str(type_)
        table.add_row(str(HEAD_BYTES + VALUE_BYTES * place), "float64", name, what)
    table.add_row(str(tail), "int32", "sequence, again", "")
    print_table(table)
