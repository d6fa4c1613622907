"""``source: {kind: udp}``: somebody outside, asked by datagrams (`dse docs udp`)."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path
from typing import TypeVar

from dse.domain.component import Causality, Component, Kind, Type
from dse.domain.udp import LINK, LinkMode, LinkRole, UdpSource, heard, sent
from dse.errors import Location, Problem, closest, fail, raise_if_any
from dse.kinds._generated import build_generated
from dse.kinds._partner import members_of, struct_lines
from dse.loading import ComponentKind, Plain, SourcePlace, SourceSection

_STRUCT = "outside"
_MOST_VALUES = 8000
_LOOPBACK = "127.0.0.1"
_ADDRESS = re.compile(r"[A-Za-z0-9]([A-Za-z0-9.-]*[A-Za-z0-9])?|[0-9A-Fa-f:.]*:[0-9A-Fa-f:.]*", re.ASCII)
_LONGEST = 3600.0
_Word = TypeVar("_Word", bound=StrEnum)


class UdpSection(SourceSection):
    """The keys of ``source``."""

    port: int | None = None
    host: str | None = None
    listen: str | None = None
    role: str = LinkRole.CLIENT
    mode: str = LinkMode.LOCKSTEP
    timeout: Plain | None = None
    wait: Plain | None = None


class UdpKind(ComponentKind[UdpSection, UdpSource]):
    """The values go out and come back in every step; no code is written (docs/decisions/0033-udp.md)."""

    section = UdpSection

    def read(self, section: UdpSection, place: SourcePlace) -> UdpSource:
        """Where the other side is, and who of the two asks. Raises DseError."""
        if section.port is None:
            raise place.missing("port", "port: 5005")
        if not 1 <= section.port <= 65535:
            raise fail(f"there is no port {section.port}", place.at("port"), "ports are 1 to 65535")
        role = _one_of(LinkRole, section.role, place.at("role"))
        mode = _one_of(LinkMode, section.mode, place.at("mode"))
        key, other = ("listen", "host") if role is LinkRole.SERVER else ("host", "listen")
        if getattr(section, other) is not None:
            hint = "a client has a 'host' to ask; a server listens on loopback or at the address in 'listen'"
            raise fail(f"a {role} has no '{other}'", place.at(other), hint)
        host = getattr(section, key) or _LOOPBACK
        if not _ADDRESS.fullmatch(host):
            raise fail(f"'{host}' is not an address", place.at(key), f"{key}: 192.168.1.20")
        timeout = _seconds(section.timeout, place, "timeout", 5.0)
        wait = _seconds(section.wait, place, "wait", timeout)
        return UdpSource(section.port, host, role, mode, timeout, wait, where=place.entry.key)

    def build(self, component: Component, source: UdpSource, *, version: int, cache: Path | None) -> Path:
        """The FMU. Raises DseError: its ports cannot go over a datagram, or this system has no POSIX sockets."""
        self.check(component, source)
        files = {f"{_STRUCT}.h": _header(component, source), f"{_STRUCT}.c": _code(component)}
        return build_generated(component, files, _STRUCT, version=version, cache=cache, is_live=True)

    def check(self, component: Component, source: UdpSource) -> tuple[()]:  # its place tells nothing
        """Raise DseError with what cannot go over a datagram."""
        if sys.platform == "win32":
            raise fail("components of the kind udp are built on Linux and macOS only", component.where)
        raise_if_any(list(_misfits(component)))
        return ()


def _one_of(words: type[_Word], word: str, where: Location) -> _Word:
    if word not in list(words):
        raise fail(f"'{word}' is none of {', '.join(words)}", where, closest(word, list(words)))
    return words(word)


def _seconds(raw: Plain | None, place: SourcePlace, key: str, usual: float) -> float:
    seconds = usual if raw is None else place.number(raw, "s", key)
    if not 0 < seconds <= _LONGEST:
        raise fail(f"'{key}' is more than 0 s and at most 1 h, not {raw}", place.at(key), f"{key}: 5 s")
    return seconds


def _misfits(component: Component) -> Iterator[Problem]:
    name = f"component '{component.name}'"
    for port in component.interface.ports:
        if not port.type.kind.is_number:
            what = f"{name}: {port.causality} '{port.name}' is a {port.type.kind}: a datagram holds numbers only"
            yield Problem(what, component.where)
        if port.name in LINK and port.causality is Causality.OUTPUT and _is_odd(port.name, port.type):
            unit = "s" if port.name == LINK[-1] else "1"
            yield Problem(f"{name}: '{port.name}' is counted by the component, in {unit}", component.where)
    for parameter in component.parameters:
        if not parameter.type.kind.is_number:
            what = f"{name}: parameter '{parameter.name}' is a {parameter.type.kind}: a datagram holds numbers only"
            yield Problem(what, parameter.where)
    for what, values in (("sent", sent(component)), ("heard", heard(component))):
        if len(values) > _MOST_VALUES:
            yield Problem(
                f"{name}: {len(values)} values are {what} at once: a datagram holds {_MOST_VALUES}", component.where
            )


def _is_odd(name: str, type_: Type) -> bool:
    return type_.kind is not Kind.REAL or str(type_) != ("s" if name == LINK[-1] else "1")


def _header(component: Component, source: UdpSource) -> str:
    asked, answered = len(sent(component)), len(heard(component))
    wholes = "".join(
        f"{{{place}, {least}, {most}}}, "
        for place, (_, type_) in enumerate(heard(component))
        for least, most in _range(type_)
    )
    lines = "\n".join(struct_lines([*_sent_members(component), *_out_members(component)]))
    return f"""#pragma once
#include <stdbool.h>
#include <stdint.h>

#define DSE_UDP
#define DSE_UDP_SENT {asked}
#define DSE_UDP_HEARD {answered}
#define DSE_UDP_WHOLES {wholes}
#define DSE_UDP_HOST "{source.host}"
#define DSE_UDP_PORT "{source.port}"
#define DSE_UDP_IS_SERVER {int(source.role is LinkRole.SERVER)}
#define DSE_UDP_IS_FREE {int(source.mode is LinkMode.FREE)}
#define DSE_UDP_TIMEOUT {source.timeout!r}
#define DSE_UDP_WAIT {source.wait!r}
{"" if source.host else "#define DSE_UDP_FIRST_RESEND DSE_UDP_WAIT"}
{"" if source.layout is None else f"#define DSE_UDP_LAYOUT {source.layout}.0"}
{_answers(source)}
#define dse_component_take {_STRUCT}_take

typedef struct {{
{lines}
    double ask[{max(asked, 1)}], answer[{answered + len(LINK)}]; /* at the end what is counted */
}} {_STRUCT};
void {_STRUCT}_init({_STRUCT} *self);
void {_STRUCT}_step({_STRUCT} *self, double h);
void {_STRUCT}_take({_STRUCT} *self);
"""


def _answers(source: UdpSource) -> str:
    if source.answers is None:
        return ""
    host, port = source.answers
    return f'#define DSE_UDP_ANSWERS_HOST "{host}"\n#define DSE_UDP_ANSWERS_PORT "{port}"'


def _code(component: Component) -> str:
    places = {name: place for place, (name, _) in enumerate(heard(component))}
    places |= {name: len(places) + place for place, name in enumerate(LINK)}
    outputs = [port.name for port in component.interface.ports if port.causality is Causality.OUTPUT]
    asks = "".join(f"    self->ask[{n}] = self->{member};\n" for n, (member, _) in enumerate(_sent_members(component)))
    takes = "".join(
        f"    self->{member} = ({type_})self->answer[{places[name]}];\n"
        for name, (member, type_) in zip(outputs, _out_members(component), strict=True)
    )
    return f"""#include "{_STRUCT}.h"

void {_STRUCT}_init({_STRUCT} *self) {{ {_STRUCT}_step(self, 0.0); }}

void {_STRUCT}_step({_STRUCT} *self, double h) {{
    (void)self, (void)h;
{asks}}}

void {_STRUCT}_take({_STRUCT} *self) {{
    (void)self;
{takes}}}
"""


def _range(type_: Type) -> Iterator[tuple[str, str]]:
    match type_.kind:
        case Kind.BOOLEAN:
            yield "0.0", "1.0"
        case Kind.ENUMERATION:
            yield "0.0", f"{len(type_.items) - 1}.0"
        case Kind.INTEGER:
            yield "INT32_MIN", "INT32_MAX"


def _sent_members(component: Component) -> list[tuple[str, str]]:
    return members_of(component, ("in", "par"))


def _out_members(component: Component) -> list[tuple[str, str]]:
    return members_of(component, ("out",))


KIND = UdpKind()
