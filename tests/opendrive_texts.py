"""OpenDRIVE as the tests write it: short, with what each of them is about."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from dse.world import Network, read_network

ZERO = ' a="0" b="0" c="0" d="0"'


def factors(*values: float) -> str:
    """a, b, c and d as attributes; those left out are 0."""
    return "".join(f' {name}="{value!r}"' for name, value in zip("abcd", (*values, 0.0, 0.0, 0.0), strict=False))


def geometry(s: float, x: float, y: float, heading: float, length: float, shape: str = "<line/>") -> str:
    return f'<geometry s="{s!r}" x="{x!r}" y="{y!r}" hdg="{heading!r}" length="{length!r}">{shape}</geometry>\n'


def lane(
    id_: int,
    width: float | str = 3.5,
    type_: str = "driving",
    before: int = 0,
    after: int = 0,
    more: str = "",
    attributes: str = "",
) -> str:
    links = (f'<predecessor id="{before}"/>' if before else "") + (f'<successor id="{after}"/>' if after else "")
    widths = width if isinstance(width, str) else f'<width sOffset="0"{factors(width)}/>'
    return f'<lane id="{id_}" type="{type_}"{attributes}><link>{links}</link>{widths}{more}</lane>\n'


def section(s: float, left: str = "", right: str = "", attributes: str = "") -> str:
    sides = [f"<{side}>{lanes}</{side}>" if lanes else "" for side, lanes in (("left", left), ("right", right))]
    middle = '<center><lane id="0" type="none"/></center>'
    return f'<laneSection s="{s!r}"{attributes}>{sides[0]}{middle}{sides[1]}</laneSection>\n'


def road(
    id_: str,
    plan: str,
    length: float,
    sections: str = "",
    *,
    link: str = "",
    junction: str = "-1",
    offset: str = "",
    more: str = "",
    rule: str = "RHT",
) -> str:
    lanes = sections or section(0.0, lane(1), lane(-1))
    return (
        f'<road id="{id_}" length="{length!r}" junction="{junction}" rule="{rule}">\n<link>{link}</link>\n{more}'
        f"<planView>\n{plan}</planView>\n<lanes>{offset}\n{lanes}</lanes></road>\n"
    )


def to_road(which: str, id_: str, contact: str) -> str:
    return f'<{which} elementType="road" elementId="{id_}" contactPoint="{contact}"/>'


def to_junction(which: str, id_: str) -> str:
    return f'<{which} elementType="junction" elementId="{id_}"/>'


def connection(incoming: str, connecting: str, contact: str, links: Iterable[Sequence[int]]) -> str:
    pairs = "".join(f'<laneLink from="{one}" to="{other}"/>' for one, other in links)
    return (
        f'<connection id="{incoming}-{connecting}" incomingRoad="{incoming}" connectingRoad="{connecting}" '
        f'contactPoint="{contact}">{pairs}</connection>\n'
    )


def opendrive(*parts: str, minor: int = 7) -> str:
    head = f'<?xml version="1.0"?>\n<OpenDRIVE>\n<header revMajor="1" revMinor="{minor}"/>\n'
    return f"{head}{''.join(parts)}</OpenDRIVE>\n"


def network(folder: Path, *parts: str, minor: int = 7) -> Network:
    """What is read of a file of these parts."""
    file = folder / "road.xodr"
    file.write_text(opendrive(*parts, minor=minor), "utf-8")
    return read_network(file, file.name)
