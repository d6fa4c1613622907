"""A design space as a dealership: choose, and see what that leaves."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from dse.api.spaces.design import Design
from dse.domain.design import DesignSpace
from dse.errors import DseError, Problem, raise_if_any

if TYPE_CHECKING:
    from dse.space import Dealership as Offers, Offer, OpenedSpace, Rows


class Dealership:
    """Offers of a design; what has to be compiled is kept, so make one and ask it often.

    Raises DseError, when it is asked first, for a design that is too large to be compiled.
    """

    def __init__(self, design: Design | DesignSpace) -> None:
        self._opened = (design if isinstance(design, Design) else Design.of(design)).opened

    def offer(self, chosen: Mapping[str, str] | None = None) -> Offer:
        """What is left under what is *chosen* by path (``absent``: left out); see `Offer`.

        Raises DseError for a place or an alternative that does not exist.
        """
        return self._offers.offer(chosen or {})

    def cheapest(self, chosen: Mapping[str, str] | None = None, total: str = "cost") -> dict[str, str]:
        """All choices (``absent``: left out) of the configuration with what is *chosen* whose sum of *total* is least.

        Raises DseError if there is none.
        """
        from dse.space import read_aims

        part = self._part(chosen)
        found = part.best(read_aims([f"sum({total})"], [])[0], 1)
        if not found:
            raise part.nothing()
        return self._whole(part, part.engine.flat.row(found[0].choices))

    def surprise(self, chosen: Mapping[str, str] | None = None, seed: int = 0) -> dict[str, str]:
        """All choices of a configuration with what is *chosen*, each as likely as any other. DseError without one."""
        part = self._part(chosen)
        return self._whole(part, part.draw(1, seed)[0])

    @cached_property
    def _offers(self) -> Offers:
        return self._opened().dealership()

    def _whole(self, part: OpenedSpace, row: Rows) -> dict[str, str]:
        """The choices of a row, and what it leaves out."""
        variables = zip(part.engine.flat.variables, row.tolist(), strict=True)
        return {each.path: each.values[value] or _ABSENT for each, value in variables if value >= 0}

    def _part(self, chosen: Mapping[str, str] | None) -> OpenedSpace:
        return self._opened().part(f"{path}={name}" for path, name in (chosen or {}).items())


def choices_text(chosen: Mapping[str, str]) -> str:
    """*chosen* as it stands in a link: ``sensor:radar,brake:absent``, in the order of their paths."""
    return ",".join(f"{path}:{name}" for path, name in sorted(chosen.items()))


def read_choices_text(text: str) -> dict[str, str]:
    """What is chosen by path, out of what `choices_text` gives; "" is nothing. Raises DseError with all problems.

    Whether a design has these places is not looked at: that is for its offer to say.
    """
    if len(text) > _LONGEST:
        raise DseError(Problem(f"the choices are longer than {_LONGEST:,} characters", None, "copy the link again"))
    chosen: dict[str, str] = {}
    problems: list[Problem] = []
    for piece in _pieces(text):
        path, _, name = (each.strip() for each in piece.partition(":"))
        if not path or not name or ":" in name:
            problems.append(Problem(f"'{piece[:80]}' is not a choice", None, "write place:choice, as sensor:radar"))
        elif chosen.setdefault(path, name) != name:
            problems.append(Problem(f"'{path[:80]}' is given twice", None, "give it once"))
    raise_if_any(problems)
    return chosen


_LONGEST = 20_000
_ABSENT = "absent"


def _pieces(text: str) -> Iterable[str]:
    return text.split(",") if text.strip() else ()
