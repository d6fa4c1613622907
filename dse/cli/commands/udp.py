"""``dse udp``: for people who write the other side of a component of the kind udp."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from dse.cli.app import group
from dse.cli.arguments import Format, Output
from dse.cli.endings import RUNS_FAILED
from dse.cli.terminal import plain_table, print_json, print_line, print_table

if TYPE_CHECKING:
    from dse.live import Checked, Datagram, Layout

udp_app = group("udp", "Check, record and describe the datagrams of an external world (`dse docs udp_clients`).")

_PORTS = 65535
Seconds = Annotated[float, typer.Option("--seconds", min=0.0, help="Stop after this many seconds; 0: at Ctrl-C.")]
Count = Annotated[int, typer.Option("--count", min=0, help="Stop after this many datagrams; 0: at Ctrl-C.")]
Port = Annotated[int, typer.Argument(metavar="PORT", min=1, max=_PORTS, help="The port to listen at.")]
Host = Annotated[str, typer.Option("--host", metavar="ADDRESS", help="Listen on this address instead of loopback.")]
Component = Annotated[
    str | None, typer.Option("--component", metavar="NAME", help="Values as the ports of a component.")
]
LayoutFile = Annotated[
    Path | None, typer.Option("--layout", metavar="FILE", help="Values as in a file of 'dse udp layout'.")
]
Out = Annotated[int | None, typer.Option("--out", min=0, help="Number of values from the client to the world.")]
Back = Annotated[int | None, typer.Option("--back", min=0, help="Number of values from the world to the client.")]


@udp_app.command("check")
def check(
    world: Annotated[str, typer.Argument(metavar="[HOST:PORT]", help="The address of the world.")] = "",
    out: Out = None,
    back: Back = None,
    component: Component = None,
    layout: LayoutFile = None,
    step: Annotated[float, typer.Option("--step", min=1e-6, help="The client's step in s.")] = 0.01,
    steps: Annotated[int, typer.Option("--steps", min=3, max=1_000_000, help="Number of requested steps.")] = 100,
    timeout: Annotated[float, typer.Option("--timeout", min=0.01, help="Seconds to wait for packets.")] = 5.0,
    listen: Annotated[
        int, typer.Option("--listen", metavar="PORT", min=0, max=_PORTS, help="Check a client that sends to this port.")
    ] = 0,
    host: Host = "127.0.0.1",
    wait: Annotated[float, typer.Option("--wait", min=0.01, help="With --listen: seconds to wait for START.")] = 60.0,
    output: Format = Output.TABLE,
) -> None:
    """Check a world that you wrote, in lockstep, or with --listen a client.

    Simulates the other side: START, steps, repeated requests, truncated, short, old and foreign packets, END; and
    reports errors in the received bytes. Exit code 3 if there are any.
    """
    from dse.live import WorldTrial, check_client, check_world, connected_line, listen_at, wholes_of

    sides = _layout(component, layout, out, back)
    sizes = len(sides.out), len(sides.back)
    if bool(world) == bool(listen):
        raise typer.BadParameter("give either HOST:PORT of a world, or --listen PORT for a client")
    if listen:
        with _socket_errors(host, listen), listen_at(host, listen) as line:
            print_line(f"listening at {host}:{listen} for START, packets of {28 + 8 * sizes[0]} bytes", stderr=True)
            found = check_client(line, *sizes, step=step, wait=wait, patience=timeout, wholes=wholes_of(sides.back))
    else:
        to = _address(world, "HOST:PORT")
        with _socket_errors(*to):
            opened = connected_line(*to)
        with opened.socket:
            found = check_world(opened, WorldTrial(*sizes, step, steps, timeout, wholes_of(sides.out)))
    _show_checked(found, output)
    if not found.is_right:
        raise typer.Exit(RUNS_FAILED)


@udp_app.command("layout")
def layout(
    component: Annotated[str | None, typer.Argument(metavar="COMPONENT", help="A component's name.")] = None,
    file: LayoutFile = None,
    target: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="Write a file for --layout.")
    ] = None,
    output: Format = Output.TABLE,
) -> None:
    """Show the position of each value in the packets of a component."""
    from dse.live import offset_of, size_of, written_layout
    from dse.scratch import write_whole

    sides = _layout(component, file, None, None)
    if target is not None:
        write_whole(target, written_layout(sides))
        print_line(f"{target}: {len(sides.out)} values out, {len(sides.back)} back")
        return
    ways = {"out": sides.out, "back": sides.back}
    if output is Output.JSON:
        print_json(
            {
                way: {
                    "size": size_of(len(signals)),
                    "values": [
                        {"offset": offset_of(place), "name": signal.name, "unit": signal.unit}
                        for place, signal in enumerate(signals)
                    ],
                }
                for way, signals in ways.items()
            }
        )
        return
    for way, signals in ways.items():
        whom = "client to world" if way == "out" else "world to client"
        print_line(f"{way} ({whom}): {size_of(len(signals))} bytes, little-endian", style="bold")
        table = plain_table("byte", "type", "what", right=["byte"])
        for place, name in enumerate(("magic and version, 0x44534531", "session", "sequence", "flags")):
            table.add_row(str(4 * place), "int32", name)
        table.add_row("16", "double", "time [s]")
        for place, signal in enumerate(signals):
            table.add_row(str(offset_of(place)), "double", str(signal))
        table.add_row(str(offset_of(len(signals))), "int32", "sequence again")
        print_table(table)


@udp_app.command("record")
def record(
    port: Port,
    target: Annotated[
        Path, typer.Argument(metavar="FILE", help="The file to write, with a line of JSON per datagram.")
    ],
    forward: Annotated[
        str,
        typer.Option(
            "--forward", metavar="HOST:PORT", help="Forward requests to the world there, and return its answers."
        ),
    ] = "",
    answers: Annotated[
        str, typer.Option("--answers", metavar="HOST:PORT", help="Send answers there, not to the sender of a request.")
    ] = "",
    host: Host = "127.0.0.1",
    seconds: Seconds = 0.0,
    count: Count = 0,
) -> None:
    """Record every datagram that arrives at a port, with its time.

    With --forward, it relays between both sides: the client sends to PORT, the world listens elsewhere.
    """
    from dse.live import listen_at, tap, write_datagram, write_head

    onward = _address(forward, "--forward") if forward else None
    back = _address(answers, "--answers") if answers else None
    if back and not onward:
        raise typer.BadParameter("without --forward there are no answers", param_hint="--answers")
    heard = 0

    def keep(datagram: Datagram) -> None:
        nonlocal heard
        heard += 1
        write_datagram(file, datagram)

    with _socket_errors(host, port), listen_at(host, port) as line, target.open("w", 1, encoding="utf-8") as file:
        write_head(file)
        print_line(f"listening at {host}:{port}; Ctrl-C ends it", stderr=True)
        try:
            tap(line, onward, keep, most=count or 2**62, seconds=seconds or 1e12, answers=back)
        except KeyboardInterrupt:
            print_line(f"{target}: {heard} datagrams", stderr=True)
            raise
    print_line(f"{target}: {heard} datagrams")


@udp_app.command("show")
def show(
    recording: Annotated[Path, typer.Argument(metavar="FILE", help="A recording of 'dse udp record'.")],
    out: Out = None,
    back: Back = None,
    component: Component = None,
    layout: LayoutFile = None,
    most: Annotated[int, typer.Option("--limit", min=1, help="Maximum number of datagrams.")] = 200,
    output: Format = Output.TABLE,
) -> None:
    """Show a recording: the sender, time, content and errors of each datagram.

    Values have names with --component or --layout; otherwise their number follows from the bytes.
    """
    from itertools import islice

    from dse.live import read_recording

    asked = (component, layout, out, back) != (None, None, None, None)
    sides = _layout(component, layout, out, back) if asked else None
    whole = read_recording(recording)
    rows = [_row(datagram, sides) for datagram in islice(whole, most)]
    more = sum(1 for _ in whole)
    if output is Output.JSON:
        print_json(rows)
        return
    table = plain_table("time [s]", "from", "bytes", "session", "sequence", "flags", "t [s]", "", right=["bytes"])
    for row in rows:
        values = ", ".join(f"{name} {value:.6g}" for name, value in row.get("values", {}).items())
        told = row.get("wrong") or values
        numbers = (row["session"], row["sequence"], row["flags"], f"{row['t']:.6g}") if "t" in row else ("",) * 4
        way = "world" if row["way"] == "back" else "client"
        table.add_row(f"{row['time']:.6f}", way, str(row["bytes"]), *map(str, numbers), told)
    print_table(table)
    if more:
        print_line(f"and {more} more (--limit)", stderr=True)


def _row(datagram: Datagram, sides: Layout | None) -> dict[str, Any]:
    from dse.live import PacketError, Signal, explain, unpack

    row: dict[str, Any] = {
        "time": datagram.time,
        "way": "back" if datagram.is_answer else "out",
        "from": datagram.sender,
        "bytes": len(datagram.data),
    }
    guessed = max(0, min(8000, (len(datagram.data) - 28) // 8))
    signals = tuple(Signal(str(place + 1)) for place in range(guessed))
    if sides is not None:
        signals = sides.back if datagram.is_answer else sides.out
    try:
        packet = unpack(datagram.data, len(signals))
    except PacketError as error:
        return {**row, "wrong": explain(datagram.data, len(signals)) or str(error)}
    flags = "|".join(flag.name or "" for flag in packet.flags)
    values = {signal.name: value for signal, value in zip(signals, packet.values, strict=True)}
    head = {"session": packet.session, "sequence": packet.sequence, "flags": flags, "t": packet.time}
    return {**row, **head, "values": values, "wrong": explain(datagram.data, len(signals))}


def _layout(component: str | None, file: Path | None, out: int | None, back: int | None) -> Layout:
    from dse.live import component_layout, read_layout, unnamed_layout

    counts = (out, back) != (None, None)
    if sum((component is not None, file is not None, counts)) != 1:
        raise typer.BadParameter("define the values: --component NAME, --layout FILE, or --out N --back M")
    if file is not None:
        return read_layout(file)
    if component is not None:
        from dse.loading import Workspace

        return component_layout(Workspace.around(Path()).component(component))
    return unnamed_layout(out or 0, back or 0)


def _address(text: str, name: str) -> tuple[str, int]:
    host, _, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) <= _PORTS:
        raise typer.BadParameter(f"'{text}' is not a HOST:PORT, as 127.0.0.1:5005", param_hint=name)
    return host.strip("[]"), int(port)


@contextmanager
def _socket_errors(host: str, port: int) -> Iterator[None]:
    """What the system says of an address, as one problem."""
    from dse.errors import fail

    try:
        yield
    except OSError as error:
        if error.filename is not None:
            raise
        raise fail(
            f"{host}:{port}: {error.strerror or error}", hint="is it another program's, or no address?"
        ) from error


def _show_checked(found: Checked, output: Output) -> None:
    latencies = found.latencies
    shares = {"median": 0.5, "p90": 0.9, "p99": 0.99, "worst": 1.0}
    if output is Output.JSON:
        print_json(
            {
                "ok": found.is_right,
                "checks": [
                    {"check": check.name, "ok": check.is_right, "said": list(check.said)} for check in found.checks
                ],
                "latency": {name: latencies.quantile(share) for name, share in shares.items()},
                "exchanges": len(latencies.seconds) or found.steps,
                "resent": latencies.resent,
                "ignored": found.ignored,
            }
        )
        return
    words = {True: "ok", False: "wrong", None: "not tried"}
    for check in found.checks:
        style = {True: "green", False: "red", None: "dim"}[check.is_right]
        print_line(f"{words[check.is_right]:10}{check.name}", style=style)
        for said in check.said:
            print_line(f"{'':12}{said}")
    if latencies.seconds:
        count, milliseconds = len(latencies.seconds), [1e3 * latencies.quantile(share) for share in shares.values()]
        table = plain_table("exchanges", *(f"{name} [ms]" for name in shares), "sent again", "1/s")
        rate = count / latencies.duration if latencies.duration else 0.0
        table.add_row(str(count), *(f"{value:.3f}" for value in milliseconds), str(latencies.resent), f"{rate:.0f}")
        print_table(table)
    elif found.steps:
        print_line(f"{found.steps} steps, {found.ignored} datagrams ignored")
