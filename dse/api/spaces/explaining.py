"""Why a configuration is excluded, or whether some choices can be completed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dse.api.spaces.question import Question, ask

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dse.domain.design import Constraint
    from dse.space.decisions import Choices
    from dse.space.questions.explain import Broken
    from dse.space.questions.nearest import Nearest


@dataclass(frozen=True, slots=True)
class Explanation:
    """What is to be said of some choices, asked about in *question*.

    If they are those of a whole configuration, *choices* are its, *broken* the constraints it breaks and *nearest* the
    valid configuration next to it. Else *choices* are those of the first valid configuration that has them, None if
    there is none; then *conflict* are the constraints that stand in the way, none if the choices exclude each other.
    """

    question: Question
    is_whole: bool
    choices: Choices | None
    broken: tuple[Broken, ...] = ()
    nearest: Nearest | None = None
    conflict: tuple[Constraint, ...] = ()

    @property
    def is_valid(self) -> bool:
        """Whether a valid configuration has the choices."""
        return self.choices is not None and not self.broken

    @property
    def id(self) -> str:
        """The id of the configuration with *choices*; "" if there is none."""
        from dse.space.identify import identify

        return identify(self.choices) if self.choices is not None else ""

    def __repr__(self) -> str:
        if self.is_whole:
            said = f"breaks {', '.join(entry.constraint.name for entry in self.broken)}" if self.broken else "valid"
            return f"<Explanation of {self.id}: {said}>"
        said = f"completed by {self.id}" if self.is_valid else f"excluded by {', '.join(c.name for c in self.conflict)}"
        return f"<Explanation of {', '.join(f'{path}={name}' for path, name in self.question.chosen.items())}: {said}>"


def explain(whole: Question, choose: Iterable[str]) -> Explanation:
    """What is to be said of texts ``place=choice`` among the configurations of *whole*. Raises DseError."""
    from dse.space.choosing import completed, read_choices
    from dse.space.questions.conflict import conflict
    from dse.space.questions.explain import explain as broken_by
    from dse.space.questions.nearest import nearest

    texts = tuple(choose)
    configuration = completed(whole.space, read_choices(whole.space, texts))
    if configuration is not None:
        broken = broken_by(whole.space, configuration)
        # Its engine is that of the whole space: a configuration is compared with all others.
        near = nearest(whole.engine, configuration) if broken and not whole.engine.is_empty() else None
        return Explanation(whole, True, configuration, broken, near)
    part = ask(whole.space, texts, whole.where)
    row = part.engine.first()
    if row is None:
        return Explanation(part, False, None, conflict=conflict(part.engine))
    return Explanation(part, False, part.engine.flat.choices(row))
