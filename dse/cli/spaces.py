"""What commands about design spaces show: how many there are, and constraints; for a person and for a program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dse.cli.terminal import print_line
from dse.space import significant

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dse.domain.design import Constraint
    from dse.space import Tally

_READABLE = 10**12
"""Numbers from here on are shown in short, too."""

_HUGE = 10**36
"""Numbers from here on have more digits than anyone reads."""


def number_text(number: int) -> str:
    """A count with all its digits; a large one in short before them: ``1.003e24 (1,003,…)``, a huge one only so."""
    if number < _READABLE:
        return f"{number:,}"
    return f"{short(number)} ({number:,})" if number < _HUGE else short(number)


def short(number: int) -> str:
    """Four digits at most: ``1.003e24``."""
    return significant(number, 4)


def tally_text(tally: Tally) -> str:
    """A count, or an estimate with its interval: ``≈ 1.003e24 ± 3.9e21 (95 %)``."""
    if tally.exact:
        return number_text(tally.value)
    return f"≈ {short(tally.value)} ± {tally.half_width} (95 %)"


def tally_cell(tally: Tally) -> str:
    """The same for a cell of a table, where there is no room for all digits."""
    if tally.exact:
        return f"{tally.value:,}" if tally.value < _READABLE else short(tally.value)
    return tally_text(tally).removesuffix(" (95 %)")


def tally_data(tally: Tally) -> dict[str, Any]:
    """``valid`` and ``exact``; for an estimate the ends ``low`` and ``high`` of its 95 % interval, too."""
    data: dict[str, Any] = {"valid": tally.value, "exact": tally.exact}
    return data if tally.exact else data | {"low": tally.low, "high": tally.high}


def constraint_data(constraint: Constraint) -> dict[str, object]:
    """A constraint for `print_json`."""
    where = str(constraint.where) if constraint.where else None
    return {
        "constraint": constraint.name,
        "text": constraint.rule.text,
        "because": constraint.because,
        "where": where,
    }


def show_constraints(constraints: Iterable[Constraint]) -> None:
    """Constraints in the user's words, the reason and the place in the file below each."""
    for constraint in constraints:
        text = " ".join(constraint.rule.text.split())
        print_line(f"  {constraint.name}: {text}")
        beside = [constraint.because] if constraint.because and constraint.because != text else []
        beside += [str(constraint.where)] if constraint.where else []
        if beside:
            print_line(f"      {' · '.join(beside)}", style="dim")
