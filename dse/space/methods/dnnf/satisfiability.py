"""Whether a wide space has a row at all, and if not, which constraints are to blame."""

from __future__ import annotations

from collections.abc import Collection

from dse.space.flat import NO_OWNER, FlatSpace, Rows
from dse.space.methods.dnnf.cnf import encode
from dse.space.methods.dnnf.compile import Dnnf
from dse.space.methods.dnnf.graph import DecisionGraph
from dse.space.methods.dnnf.rows import rows_of_model
from dse.space.methods.dnnf.solver import ClauseSolver
from dse.space.methods.dnnf.trim import trim


def satisfiable(flat: FlatSpace) -> Rows | None:
    """A row that meets all rules, shape (variables,), or None. Raises UnsupportedError as `compile_dnnf` does."""
    trimmed = trim(flat)
    cnf = encode(trimmed.core)
    solver = ClauseSolver(cnf.booleans)
    for clause in cnf.clauses:
        solver.add(clause)
    holds = solver.solve()
    if holds is None:
        return None
    literals = [2 * boolean + (not holds[boolean]) for boolean in range(1, cnf.booleans)]
    dnnf = Dnnf(trimmed, cnf, tuple(range(2 * cnf.booleans)), cnf.booleans, DecisionGraph((), None))
    row: Rows = next(rows_of_model(dnnf, literals))[0]
    return row


def conflict(flat: FlatSpace) -> tuple[int, ...] | None:
    """Owners of rules that cannot be met together, ascending; None if there is a row.

    Minimal: without any one of them, rules of the others can be met. Empty if the structure alone has no row. Raises
    UnsupportedError as `compile_dnnf` does.
    """
    cnf = encode(trim(flat).core)
    owners = sorted({owner for owner in cnf.owners if owner != NO_OWNER})
    switch = {owner: 2 * (cnf.booleans + at) for at, owner in enumerate(owners)}
    solver = ClauseSolver(cnf.booleans + len(owners))
    for clause, owner in zip(cnf.clauses, cnf.owners, strict=True):
        solver.add(clause if owner == NO_OWNER else (*clause, switch[owner] ^ 1))
    blamed = solver.explain([switch[owner] for owner in owners])
    if blamed is None:
        return None
    return tuple(_fewest(solver, blamed, {literal: owner for owner, literal in switch.items()}))


def _fewest(solver: ClauseSolver, blamed: Collection[int], owner_of: dict[int, int]) -> list[int]:
    """Leave out one after another what is not needed; each answer may rule out several at once."""
    needed: list[int] = []
    suspects = sorted(blamed)
    while suspects:
        tried = suspects.pop()
        blamed_now = solver.explain([*needed, *suspects])
        if blamed_now is None:
            needed.append(tried)
        else:
            suspects = [literal for literal in suspects if literal in blamed_now]
    return sorted(owner_of[literal] for literal in needed)
