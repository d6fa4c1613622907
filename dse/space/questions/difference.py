"""What two design spaces have in common, and what only one of them has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from dse.space.flat import FlatSpace
from dse.space.methods.engine import Engine
from dse.space.methods.tally import Tally
from dse.space.questions.overlay import overlay


@dataclass(frozen=True, slots=True)
class Difference:
    """Alternatives as (path, choice), None for leaving a part out; constraints by name; configurations by number.

    *changed*: constraints of one name that say different things. *common* configurations make the same choices.
    """

    removed: tuple[tuple[str, str | None], ...]
    added: tuple[tuple[str, str | None], ...]
    constraints_removed: tuple[str, ...]
    constraints_added: tuple[str, ...]
    changed: tuple[str, ...]
    before: Tally
    after: Tally
    common: Tally


def difference(old: Engine, new: Engine, seed: int = 0) -> Difference:
    """How *new* differs from *old*. Raises DseError if nothing can be counted."""
    gone, fresh = _alternatives(old.flat), _alternatives(new.flat)
    old_rules, new_rules = _texts(old.flat), _texts(new.flat)
    return Difference(
        tuple(entry for entry in gone if entry not in fresh),
        tuple(entry for entry in fresh if entry not in gone),
        tuple(name for name in old_rules if name not in new_rules),
        tuple(name for name in new_rules if name not in old_rules),
        tuple(name for name, text in old_rules.items() if new_rules.get(name, text) != text),
        old.count(seed),
        new.count(seed),
        Engine(overlay(old.flat, new.flat), old).count(seed),
    )


def _alternatives(flat: FlatSpace) -> dict[tuple[str, str | None], None]:
    return {(variable.path, value): None for variable in flat.variables for value in variable.values}


def _texts(flat: FlatSpace) -> Mapping[str, str]:
    return {constraint.name: constraint.rule.text for constraint in flat.constraints}
