"""``source: {kind: fmu}``: an existing FMU, taken as it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from dse.domain.component import Component, Source
from dse.domain.fmu import FmiInterface, Special
from dse.errors import Location, Problem, closest, fail
from dse.formats import shown
from dse.loading import ComponentKind, Plain, SourcePlace, SourceSection


class FmuSection(SourceSection):
    """The keys of ``source``."""

    file: str | None = None
    interface: str | None = None
    sampled: Plain | None = None
    exact: bool = False
    event_mode: Literal["on", "off"] | None = None
    isolate: bool = False


_WAYS = {"event_mode": Special.NO_EVENT_MODE, "isolate": Special.ISOLATED}
_INTERFACES = {interface.word: interface for interface in FmiInterface}


@dataclass(frozen=True, slots=True)
class FmuSource(Source):
    """An existing FMU, untouched; *asked* is the interface it is to be simulated by, *asked_at* where that is said.

    *ways* are what is `special`, *ways_at* where that is said. Its results have no error of their own if it is
    *sampled* every so many seconds, or *exact*: the user vouches.
    """

    kind = "fmu"
    label = "FMU"
    is_finished = True
    takes_texts = True

    file: Path
    asked: FmiInterface | None = None
    asked_at: Location | None = field(default=None, compare=False)
    sampled: float | None = None
    exact: bool = False
    ways: tuple[Special, ...] = ()
    ways_at: tuple[Location, ...] = field(default=(), compare=False)

    @property
    def sample_time(self) -> float | None:
        """What it is *sampled* by."""
        return self.sampled

    @property
    def is_exact(self) -> bool:
        """What is said."""
        return self.exact

    @property
    def interface(self) -> tuple[str, Location | None] | None:
        """The one that is asked for."""
        return None if self.asked is None else (self.asked, self.asked_at)

    @property
    def special(self) -> Mapping[str, Location]:
        """What is asked for."""
        return dict(zip(self.ways, self.ways_at, strict=True))


class FmuKind(ComponentKind[FmuSection, FmuSource]):
    """Nothing is built, whatever the FMU's version."""

    section = FmuSection

    def read(self, section: FmuSection, place: SourcePlace) -> FmuSource:
        """The archive; known by its content, so that it may lie anywhere."""
        if section.file is None:
            raise place.missing("file", "file: my_part.fmu")
        file = place.existing(place.path(section.file, "file"), "file")
        sampled = None
        if section.sampled is not None:
            sampled = place.number(section.sampled, "s", "sampled")
            if sampled <= 0:
                raise fail(f"the sample time must be positive, not {section.sampled}", place.at("sampled"))
        asked = {"event_mode": section.event_mode == "off", "isolate": section.isolate}
        ways = tuple(_WAYS[key] for key, is_asked in asked.items() if is_asked)
        ways_at = tuple(place.at(key) for key, is_asked in asked.items() if is_asked)
        if section.interface is None:
            return FmuSource(file, sampled=sampled, exact=section.exact, ways=ways, ways_at=ways_at)
        where = place.at("interface")
        if section.interface not in _INTERFACES:
            what = f"'{section.interface}' is none of {', '.join(_INTERFACES)}"
            raise fail(what, where, closest(section.interface, _INTERFACES))
        return FmuSource(file, _INTERFACES[section.interface], where, sampled, section.exact, ways, ways_at)

    def build(self, component: Component, source: FmuSource, *, version: int, cache: Path | None) -> Path:
        """The archive itself. Raises DseError if it is gone."""
        if not source.file.is_file():
            raise fail(f"component '{component.name}': there is no FMU {shown(source.file)}", component.where)
        return source.file

    def check(self, component: Component, source: FmuSource) -> tuple[Problem, ...]:
        """What the FMU has that should not be there. Raises DseError unless it has the component's ports."""
        from dse.fmu import open_component
        from dse.system import check_fmu

        model = open_component(component, source.file)
        check_fmu(component, model)
        return model.ignored


KIND = FmuKind()
