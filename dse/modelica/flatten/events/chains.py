"""When-clauses with elsewhen: which trigger is which branch of which clause.

The front-end's system gives each branch its own trigger and forgets that a later branch does nothing while an earlier
one is active. The flat model still has the clauses; a branch is found again by its place and what it assigns.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from dse.modelica.flatten.document import Document, Record, records

Span = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Branch:
    """A when- or elsewhen-branch: its condition's *span* and the names of variables and states it assigns."""

    span: Span | None
    targets: frozenset[str]


class BranchNumber(NamedTuple):
    """A when-clause and a branch of it, both by number."""

    clause: int
    branch: int


@dataclass(frozen=True, slots=True)
class Chains:
    """All when-clauses: *equations* of them in equation sections, the others in algorithms."""

    chains: tuple[tuple[Branch, ...], ...]
    equations: int

    def find(self, span: Span | None, targets: frozenset[str]) -> BranchNumber | None:
        """The branch with its condition at *span* that assigns *targets*; None if there is not exactly one."""
        found = [
            BranchNumber(number, place)
            for number, chain in enumerate(self.chains)
            for place, branch in enumerate(chain)
            if branch.span == span and targets <= branch.targets
        ]
        return found[0] if len(found) == 1 else None

    def may_follow(self, span: Span | None) -> bool:
        """Whether a condition at *span* may stand in a clause of several branches."""
        return any(len(chain) > 1 and any(branch.span == span for branch in chain) for chain in self.chains)

    def is_equation(self, place: BranchNumber) -> bool:
        """Whether *place* is in an equation section."""
        return place.clause < self.equations


def read_chains(document: Document) -> Chains:
    """The when-clauses of *document*'s flat model."""
    equations = [
        tuple(Branch(span(branch), frozenset(_targets(branch["equations"]))) for branch in branches)
        for branches in ((chain["first"], *chain["else_when"]) for chain in document.flat["when_chains"])
    ]
    algorithms = [
        tuple(Branch(span(_inner(block["cond"])), frozenset(_targets(block["stmts"]))) for block in when["blocks"])
        for when in (record.get("When") for record in records(document.flat["algorithms"]))
        if isinstance(when, dict)
    ]
    return Chains((*equations, *algorithms), len(equations))


def span(provenance: Record | None) -> Span | None:
    """The place in *provenance* as a key."""
    found = (provenance or {}).get("span")
    return (found["source"], found["start"], found["end"]) if found else None


def _inner(expression: Any) -> Any:
    """The body of an expression of the flat model, which is wrapped in its kind."""
    bodies = list(expression.values()) if isinstance(expression, dict) else []
    return bodies[0] if len(bodies) == 1 and isinstance(bodies[0], dict) else None


def _targets(equations: Any) -> Iterator[str]:
    """Names assigned anywhere in *equations* or statements, in if-equations too."""
    for record in records(equations):
        for key, name in (("Assign", "target"), ("Reinit", "state")):
            if isinstance(record.get(key), dict) and name in record[key]:
                yield str(record[key][name])
        for key in ("Assignment", "Reinit"):
            reference = record[key].get("comp") if isinstance(record.get(key), dict) else None
            if isinstance(reference, dict) and "parts" in reference:
                yield ".".join(part["ident"] for part in reference["parts"])
