"""The configuration that an id names."""

from __future__ import annotations

from dse.domain.design import Configuration, DesignSpace
from dse.errors import DseError, fail
from dse.space.configurations.ids import LENGTH, Identifier
from dse.space.configurations.resolve import Resolver
from dse.space.methods.engine import Engine

MOST_LOOKED_AT = 2_000_000
"""Configurations that are looked at before it gives up: an id does not tell where in the list it is."""


def find(space: DesignSpace, engine: Engine, name: str, most: int = MOST_LOOKED_AT) -> Configuration:
    """The configuration among those of *engine* whose id is *name* or starts with it.

    Raises DseError if there is not exactly one, or if none was found among the first *most*.
    """
    if not name:
        raise _missing(space, name)
    identifier = Identifier(engine.flat.variables)
    resolver = Resolver(space)
    found: list[Configuration] = []
    looked_at = 0
    for rows in engine.blocks():
        for number, known in enumerate(identifier.ids(rows)):
            if known.startswith(name):
                found += resolver.configurations(rows[number : number + 1])
                if known == name:
                    return found[-1]
        looked_at += len(rows)
        if looked_at >= most:
            raise _not_among(space, name, looked_at)
    if len(found) == 1:
        return found[0]
    if found:
        listed = ", ".join(configuration.id for configuration in found[:5])
        raise fail(f"{len(found)} configurations of '{space.name}' start with '{name}'", space.where, f"as {listed}")
    raise _missing(space, name)


def _missing(space: DesignSpace, name: str) -> DseError:
    hint = f"list them: dse enumerate {space.name}"
    return fail(f"'{space.name}' has no valid configuration '{name}'", space.where, hint)


def _not_among(space: DesignSpace, name: str, looked_at: int) -> DseError:
    what = f"no configuration with the id '{name}' is among the first {looked_at:,} of '{space.name}'"
    if len(name) < LENGTH:
        what = f"'{name}' may mean several of the more than {looked_at:,} configurations of '{space.name}'"
    return fail(what, space.where, "name its choices instead of its id: --choose PLACE=CHOICE for each decision")
