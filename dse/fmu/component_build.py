"""Components become FMUs, each by its kind."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import Path

from dse.domain.component import Component
from dse.errors import fail
from dse.fmu.other_platforms import with_platforms
from dse.fmu.parallel import in_parallel
from dse.fmu.toolchain.platforms import Platform
from dse.loading import KINDS, kind_of


def build(component: Component, *, version: int = 2, cache: Path | None = None) -> Path:
    """The FMU archive of *component*, for FMI *version* 2 or 3 if it has to be made; from the cache if it was.

    A finished FMU is returned as it is, whatever its version. Raises DseError: the component has no source or
    one of a kind that cannot be built, its C does not compile or lacks a port, or there is no compiler.
    """
    source, kind = component.source, kind_of(component)
    *others, last = KINDS.names()
    known = f"a source of the kind {', '.join(others)} or {last}"
    if source is None:
        what = f"component '{component.name}' has no source, so there is nothing to build"
        raise fail(what, component.where, f"it can be counted and listed only; give it {known}")
    if kind is None:
        what = f"component '{component.name}': sources of the kind '{source.kind}' cannot be built in this version"
        raise fail(what, component.where, f"use {known}")
    if version not in (2, 3) and not source.is_finished:
        raise fail(f"FMUs are built for FMI 2 and 3, not {version}")
    return kind.build(component, source, version=version, cache=cache)


def build_all(
    components: Iterable[Component],
    *,
    version: int = 2,
    cache: Path | None = None,
    platforms: Collection[Platform] = (),
) -> dict[str, Path]:
    """The archives of all *components* by name, several built at a time; with libraries for other *platforms*, too.

    Raises one DseError with the problems of all that cannot be built.
    """
    wanted = {component.name: component for component in components}

    def make(name: str) -> Path:
        archive = build(wanted[name], version=version, cache=cache)
        return with_platforms(name, archive, platforms, cache=cache) if platforms else archive

    return in_parallel(wanted, make)
