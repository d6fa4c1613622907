"""Model files as components."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from language_case import class_in

from dse.domain.component import NO_INTERFACE, Component, Kind, ModelicaSource, Parameter, Type
from dse.domain.fmu import FmuModel

Built = Callable[..., FmuModel]
MakeModel = Callable[[Path, tuple[Path, ...]], FmuModel]
Opened = Callable[..., FmuModel]


def component(file: Path, structural: Mapping[str, float] | None = None, roots: tuple[Path, ...] = ()) -> Component:
    """The model in *file* as a component that implements nothing; *structural* parameters have these values."""
    parameters = tuple(
        Parameter(name, Type(Kind.INTEGER if isinstance(value, int) else Kind.REAL), value, tunable=False)
        for name, value in (structural or {}).items()
    )
    source = ModelicaSource(class_in(file), (file,), roots)
    return Component(file.stem, NO_INTERFACE, source=source, parameters=parameters)
