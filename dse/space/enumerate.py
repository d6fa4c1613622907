"""Counting and listing the configurations of a design space.

The order is that of the file: parts are nested loops, the last part is the fastest, and an optional part is
there before it is left out. Every configuration was checked against every constraint in exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from dse.domain.design import Configuration, DesignSpace
from dse.domain.expression import Expression
from dse.errors import DseError, fail
from dse.space.decisions import Choices, decisions, product_of
from dse.space.engine import Engine
from dse.space.flat import Rows
from dse.space.identify import LENGTH, Identifier
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places
from dse.space.lowering import selecting
from dse.space.resolve import Resolver
from dse.space.tally import Tally

MOST_LOOKED_AT = 2_000_000
"""Configurations that `find` looks at before it gives up: an id does not tell where in the list it is."""


def total(space: DesignSpace) -> int:
    """The number of combinations, constraints aside; exact, and nothing is enumerated."""
    return product_of(decisions(space))


def count(space: DesignSpace, seed: int = 0) -> Tally:
    """The number of valid configurations, or an estimate with its interval where an exact count would take long.

    Raises DseError if a constraint cannot be understood, or if neither can be had.
    """
    return Engine.of(space).count(seed)


def configurations(space: DesignSpace, where: Expression | None = None) -> Iterator[Configuration]:
    """Every valid configuration for which *where* is true, one at a time, in the order of the file.

    A space whose decisions are too entangled to be compiled in that order is listed in another, always the same.
    Raises DseError, at once if a constraint cannot be understood, later if connections cannot be resolved.
    """
    return of_blocks(space, engine_of(space, where).blocks())


def engine_of(space: DesignSpace, where: Expression | None = None) -> Engine:
    """The engine of those configurations for which *where* is true. Raises DseError if it cannot be understood."""
    engine = Engine.of(space)
    return engine.having(*selecting(space, where)) if where else engine


def of_blocks(space: DesignSpace, blocks: Iterable[Rows]) -> Iterator[Configuration]:
    """The configurations of blocks of rows. Raises DseError if connections cannot be resolved."""
    resolver = Resolver(space)
    for rows in blocks:
        yield from resolver.configurations(rows)


def find(space: DesignSpace, name: str, most: int = MOST_LOOKED_AT) -> Configuration:
    """The valid configuration whose id is *name* or starts with it.

    Raises DseError if there is not exactly one, or if none was found among the first *most*.
    """
    if not name:
        raise _missing(space, name)
    engine = Engine.of(space)
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


def violated(space: DesignSpace, choices: Choices) -> tuple[str, ...]:
    """The names of the constraints that complete *choices* break, in the order of the file."""
    places = Places(space)
    return tuple(c.name for c in space.constraints if compile_in(c.rule, places).outcome(choices) is False)


def _missing(space: DesignSpace, name: str) -> DseError:
    hint = f"list them: dse enumerate {space.name}"
    return fail(f"'{space.name}' has no valid configuration '{name}'", space.where, hint)


def _not_among(space: DesignSpace, name: str, looked_at: int) -> DseError:
    what = f"no configuration with the id '{name}' is among the first {looked_at:,} of '{space.name}'"
    if len(name) < LENGTH:
        what = f"'{name}' may stand for several of the more than {looked_at:,} configurations of '{space.name}'"
    return fail(what, space.where, "name its choices instead of its id: --choose PLACE=CHOICE for each decision")
