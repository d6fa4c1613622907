"""``source: {kind: time_series}``: columns of a file over time, as drive cycles and measured data."""

from __future__ import annotations

from pathlib import Path

from dse.domain.component import Component
from dse.domain.time_series import TimeSeriesSource
from dse.kinds._generated import build_generated
from dse.loading import Column, ComponentKind, SourcePlace, SourceSection, TableSection, read_series


class TimeSeriesSection(TableSection, SourceSection):
    """The keys of ``source``."""

    columns: dict[str, Column] = {}


class TimeSeriesKind(ComponentKind[TimeSeriesSection, TimeSeriesSource]):
    """The samples become tables in C."""

    section = TimeSeriesSection

    def read(self, section: TimeSeriesSection, place: SourcePlace) -> TimeSeriesSource:
        """A column for each output. The file is opened when it is needed."""
        if not section.columns:
            raise place.missing("columns", "columns: {speed: v [km/h]}")
        columns = {port: (column, place.entry["columns"][port]) for port, column in section.columns.items()}
        return TimeSeriesSource(read_series(place.entry, section, columns, place.inside))

    def build(self, component: Component, source: TimeSeriesSource, *, version: int, cache: Path | None) -> Path:
        """The FMU. Raises DseError with what is wrong with the file and its columns."""
        from dse.series import c_files, read_samples, struct_name

        files = c_files(component, read_samples(component, source))
        return build_generated(component, files, struct_name(component), version=version, cache=cache)

    def check(self, component: Component, source: TimeSeriesSource) -> tuple[()]:
        """Raise DseError with what is wrong with the file and its columns."""
        from dse.series import read_samples

        read_samples(component, source)
        return ()


KIND = TimeSeriesKind()
