"""``source: {kind: fmu}``: a finished FMU, taken as it is."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from dse.domain.component import Component, Source
from dse.errors import fail
from dse.formats import shown
from dse.loading import ComponentKind, SourcePlace, SourceSection


class FmuSection(SourceSection):
    """The keys of ``source``."""

    file: str | None = None


@dataclass(frozen=True, slots=True)
class FmuSource(Source):
    """A finished FMU, untouched."""

    kind = "fmu"
    label = "FMU"
    is_finished = True
    takes_texts = True

    file: Path


class FmuKind(ComponentKind[FmuSection, FmuSource]):
    """Nothing is built, whatever the FMU's version."""

    section = FmuSection

    def read(self, section: FmuSection, place: SourcePlace) -> FmuSource:
        """The archive; known by its content, so that it may lie anywhere."""
        if section.file is None:
            raise place.missing("file", "file: my_part.fmu")
        return FmuSource(place.existing(place.path(section.file, "file"), "file"))

    def build(self, component: Component, source: FmuSource, *, version: int, cache: Path | None) -> Path:
        """The archive itself. Raises DseError if it is gone."""
        if not source.file.is_file():
            raise fail(f"component '{component.name}': there is no FMU {shown(source.file)}", component.where)
        return source.file

    def check(self, component: Component, source: FmuSource) -> None:
        """Raise DseError unless the FMU opens and has the component's ports and parameters."""
        from dse.fmu import open_fmu
        from dse.system import check_fmu

        check_fmu(component, open_fmu(source.file))


KIND = FmuKind()
