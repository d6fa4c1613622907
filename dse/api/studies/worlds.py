"""The world's half of a bench: where it is, what goes to and fro, and serving it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from dse.domain.udp import LinkMode, LinkRole, UdpSource, heard, sent
from dse.errors import Location, Problem, fail, raise_if_any
from dse.testbench import (
    WorldPlace,
    check_bench,
    halves_of,
    near_half,
    one_configuration,
    prepare_world,
    with_settings,
)

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.component import Component, Type
    from dse.live import News
    from dse.loading import Raw

__all__ = [
    "HEAD_BYTES",
    "VALUE_BYTES",
    "WorldLayout",
    "WorldPlace",
    "serve_bench",
    "world_at",
    "world_layout",
    "write_world",
]

_ADDRESS = re.compile(r"(?P<host>[A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\]):(?P<port>[0-9]{1,5})", re.ASCII)
_FOREVER = 3600.0
"""The longest that a start can wait; after it the next one begins."""
HEAD_BYTES, VALUE_BYTES, TAIL_BYTES = 24, 8, 4


@dataclass(frozen=True, slots=True)
class WorldLayout:
    """What goes over the border of one configuration.

    *parts* are the world's; *to_world* and *to_car* the values of the packets in their order, the last of each with the
    value *number*. *component* stands for the world, as a bench may have it.
    """

    configuration: str
    parts: tuple[str, ...]
    to_world: tuple[tuple[str, Type], ...]
    to_car: tuple[tuple[str, Type], ...]
    number: int
    component: Component


def world_at(address: str, parts: tuple[str, ...] | None = None, *, wait: float = 10.0) -> WorldPlace:
    """The world at ``HOST:PORT`` with *parts* of the bench; so many seconds are waited until it is free.

    Raises DseError for what is no address.
    """
    host, port = _host_and_port(address, "--world")
    return WorldPlace(UdpSource(port, host, wait=wait), parts)


def _host_and_port(address: str, option: str) -> tuple[str, int]:
    found = _ADDRESS.fullmatch(address)
    if found is None or not 1 <= int(found["port"]) <= 65535:
        raise fail(f"'{address}' is not a HOST:PORT", Location(option), "as '127.0.0.1:5005'")
    return found["host"].strip("[]"), int(found["port"])


def _answers_at(address: str, listen: str, port: int) -> tuple[str, int]:
    """Where answers are sent. They leave this machine only if requests may come from others, too."""
    host, answers_port = _host_and_port(address, "--answers")
    where = Location("--answers")
    if (":" in host) != (":" in listen):
        raise fail(f"'{host}' and '{listen}', where the world listens, are not both IPv4 or both IPv6", where)
    if (host, answers_port) == (listen, port):
        raise fail(f"the world itself listens at {address}", where, "give the port at which the client receives")
    if not _is_loopback(host) and _is_loopback(listen):
        hint = "if this is intended, also let the world listen at an address of this machine, as --listen 192.168.1.20"
        raise fail(f"'{host}' is not a loopback address, but the world listens on loopback only", where, hint)
    return host, answers_port


def _is_loopback(host: str) -> bool:
    from ipaddress import ip_address

    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def world_layout(
    bench: TestBench, configuration: str | None, settings: Mapping[str, Raw], place: WorldPlace
) -> WorldLayout:
    """What crosses the border of the configuration whose id starts so, or of the first. Raises DseError."""
    chosen = one_configuration(bench.design, configuration)
    halves = halves_of(check_bench(with_settings(bench, settings, chosen), chosen), place)
    component = near_half(halves, place.source).parts[halves.near_name]
    return WorldLayout(
        chosen.id, tuple(sorted(halves.far)), sent(component), heard(component), halves.number, component
    )


def serve_bench(
    bench: TestBench,
    configuration: str | None,
    settings: Mapping[str, Raw],
    *,
    port: int,
    listen: str = "127.0.0.1",
    answers: str | None = None,
    parts: tuple[str, ...] | None = None,
    free: bool = False,
    fmi: int = 2,
) -> Iterator[News]:
    """Serve the world's half of the configuration whose id starts so, or of the first, at *listen* and *port*.

    What happens comes as news, until nobody asks for more. *answers* is a ``HOST:PORT`` for clients that receive at
    another port than they send from; *free* is real time instead of lockstep. Raises DseError if there is no such half,
    it cannot be built, nobody can listen there, or answers would leave this machine while requests cannot reach it.
    """
    from dse.live import require_free, serve_world

    chosen = one_configuration(bench.design, configuration)
    mode = LinkMode.FREE if free else LinkMode.LOCKSTEP
    back = None if answers is None else _answers_at(answers, listen, port)
    source = UdpSource(port, listen, LinkRole.SERVER, mode, wait=_FOREVER, answers=back)
    place = WorldPlace(source, parts)
    prepared = prepare_world(with_settings(bench, settings, chosen), chosen, place, version=fmi)
    require_free(listen, port)
    return serve_world(prepared)


def write_world(layout: WorldLayout, folder: Path) -> tuple[Path, Path]:
    """Write the component that stands for the world, and its interface, into *folder*, which names them; returns both.

    Raises DseError if one of them is there.
    """
    from dse.loading import write_interfaces

    component, source = layout.component, layout.component.source
    assert isinstance(source, UdpSource)  # noqa: S101  # by how it is made
    interface = replace(component.interface, name=folder.resolve().name)
    lines = [
        f"component: {interface.name}",
        f"title: {component.title}",
        f"implements: {interface.name}",
        f"source: {{kind: udp, host: {source.host}, port: {source.port}}}",
        "parameters:",
        *(f"  {p.name}: {{start: {p.start}, type: int, tunable: false}}" for p in component.parameters),
    ]
    texts = {
        folder / "component.yaml": "\n".join(lines) + "\n",
        folder / "interfaces.yaml": write_interfaces([interface]),
    }
    there = (path for path in texts if path.exists())
    raise_if_any(Problem("the file already exists", Location(str(path)), "nothing is overwritten") for path in there)
    folder.mkdir(parents=True, exist_ok=True)
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
    first, second = texts
    return first, second
