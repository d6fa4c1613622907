"""Clauses with fewer Booleans: literals that are fixed, or equal to others, are taken out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from dse.graphs import components
from dse.space.methods.dnnf.cnf import TRUE_LITERAL, Cnf

FALSE_LITERAL = TRUE_LITERAL ^ 1


@dataclass(frozen=True, slots=True)
class Simplified:
    """Clauses of two or more literals over Booleans 1 to *booleans* - 1, with models one to one to those of a Cnf.

    *image* says what became of each literal: TRUE, FALSE or a literal of the new Booleans. *consistent* is false if
    there is no model; then there are no clauses.
    """

    booleans: int
    clauses: tuple[tuple[int, ...], ...]
    image: tuple[int, ...]
    consistent: bool


def simplify(cnf: Cnf) -> Simplified:
    """Unit propagation and merging of literals that imply each other, until nothing changes."""
    image = list(range(2 * cnf.booleans))
    clauses: Iterable[Sequence[int]] = cnf.clauses
    while True:
        reduced = _reduced(clauses, image)
        if reduced is None:
            return Simplified(1, (), (FALSE_LITERAL, TRUE_LITERAL) * cnf.booleans, consistent=False)
        merged = _equals(reduced, 2 * cnf.booleans)
        if merged is None:
            return Simplified(1, (), (FALSE_LITERAL, TRUE_LITERAL) * cnf.booleans, consistent=False)
        clauses = reduced
        if not merged:
            break
        _replace(image, merged)
    used = sorted({literal >> 1 for literal in image} - {TRUE_LITERAL >> 1})
    number = {boolean: at + 1 for at, boolean in enumerate(used)} | {TRUE_LITERAL >> 1: TRUE_LITERAL >> 1}
    renamed = [
        2 * number[literal >> 1] | (literal & 1) for literal in range(2 * cnf.booleans) if literal >> 1 in number
    ]
    new = dict(zip((literal for literal in range(2 * cnf.booleans) if literal >> 1 in number), renamed, strict=True))
    return Simplified(
        len(used) + 1,
        tuple(dict.fromkeys(tuple(sorted(new[literal] for literal in clause)) for clause in clauses)),
        tuple(new[literal] for literal in image),
        consistent=True,
    )


def _replace(image: list[int], changes: dict[int, int]) -> None:
    for literal, old in enumerate(image):
        image[literal] = changes.get(old, old)


def _reduced(clauses: Iterable[Sequence[int]], image: list[int]) -> list[tuple[int, ...]] | None:
    """The clauses under *image* and all that follows by unit propagation, which goes into *image*; None if absurd."""
    kept: list[tuple[int, ...]] = []
    places: dict[int, list[int]] = {}
    units: list[int] = []
    for clause in clauses:
        literals = {image[literal] for literal in clause}
        if TRUE_LITERAL in literals or any(literal ^ 1 in literals for literal in literals):
            continue
        literals.discard(FALSE_LITERAL)
        if len(literals) > 1:
            for literal in literals:
                places.setdefault(literal, []).append(len(kept))
            kept.append(tuple(literals))
        elif literals:
            units.extend(literals)
        else:
            return None
    fixed: dict[int, int] = {}
    while units:
        unit = units.pop()
        value = fixed.get(unit)
        if value == FALSE_LITERAL:
            return None
        if value == TRUE_LITERAL:
            continue
        fixed[unit], fixed[unit ^ 1] = TRUE_LITERAL, FALSE_LITERAL
        for at in places.get(unit ^ 1, ()):
            remaining = [literal for literal in kept[at] if fixed.get(literal) != FALSE_LITERAL]
            if not remaining:
                return None
            if len(remaining) == 1:
                units.append(remaining[0])
    if not fixed:
        return kept
    _replace(image, fixed)
    left = (
        tuple(literal for literal in clause if literal not in fixed)
        for clause in kept
        if not any(fixed.get(literal) == TRUE_LITERAL for literal in clause)
    )
    return list(dict.fromkeys(left))


def _equals(clauses: Iterable[Sequence[int]], literals: int) -> dict[int, int] | None:
    """Literals that pairs make equal to a smaller one (Aspvall, Plass and Tarjan 1979); None if absurd."""
    implied: list[list[int]] = [[] for _ in range(literals)]
    for clause in clauses:
        if len(clause) == 2:
            one, other = clause
            implied[one ^ 1].append(other)
            implied[other ^ 1].append(one)
    merged: dict[int, int] = {}
    for group in components(implied):
        least = group[0]
        for literal in group:
            if literal ^ 1 == least:
                return None
            merged[literal] = least
    # A group and that of its negations pick the same Boolean, because negations stay side by side in the order.
    return {literal: to for literal, to in merged.items() if literal != to}
