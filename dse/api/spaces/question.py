"""A question to a design space: the space, and which part of it is left to look at."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dse.errors import DseError, Location, fail

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from dse.domain.design import DesignSpace
    from dse.space.engine import Engine


@dataclass(frozen=True, slots=True)
class Question:
    """*engine* answers about the configurations of *space* that have what is *chosen* and meet *where*."""

    space: DesignSpace
    engine: Engine
    chosen: Mapping[str, str]
    where: str | None
    options: tuple[str, ...] = ()
    """What is typed to put it, for a hint that asks another question about the same."""

    def title(self) -> str:
        """What is asked about, for a person: ``acc_vehicle with sensor=radar where cost <= 9000 EUR``."""
        given = f" with {', '.join(f'{path}={choice}' for path, choice in self.chosen.items())}" if self.chosen else ""
        return f"{self.space.name}{given}{f' where {self.where}' if self.where else ''}"

    def data(self) -> dict[str, object]:
        """The same for a program."""
        return {"design": self.space.name, "chosen": dict(self.chosen), "where": self.where}

    def nothing(self) -> DseError:
        """The problem that no configuration is left."""
        asked = self.title().removeprefix(self.space.name)
        what = f"'{self.space.name}' has no valid configuration{asked}"
        command = shlex.join(["dse", "space", "conflict", self.space.name, *self.options])
        return fail(what, None, f"ask which constraints conflict: {command}")


def ask(
    space: DesignSpace,
    choose: Iterable[str] = (),
    where: str | None = None,
    on: Collection[str] = (),
    off: Collection[str] = (),
    engine: Engine | None = None,
) -> Question:
    """The question about *space* with sets of constraints switched, narrowed to texts ``place=choice`` and *where*.

    *engine* is that of the space so switched, if it is there already. Raises DseError with all problems.
    """
    from dse.expression.parse import parse_expression
    from dse.space.choosing import choosing, read_choices
    from dse.space.engine import Engine
    from dse.space.lowering import selecting
    from dse.space.switch import switched

    space, texts = switched(space, on, off), tuple(choose)
    chosen = read_choices(space, texts)
    condition = None if where is None else parse_expression(where, Location("--where", 1, 1))
    engine = engine or Engine.of(space)
    rules = (*choosing(engine.flat, chosen), *(selecting(space, condition) if condition else ()))
    typed = [("--choose", text) for text in texts] + [("--where", where)] * bool(where)
    typed += [*(("--on", name) for name in on), *(("--off", name) for name in off)]
    options = tuple(word for pair in typed for word in pair if word)
    return Question(space, engine.having(*rules) if rules else engine, chosen, where, options)
