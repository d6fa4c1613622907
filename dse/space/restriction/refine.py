"""A design space with fewer choices: what is no longer possible is taken out, paths and ids stay.

An alternative of which one option is left stays an alternative, and an optional part that must be there becomes one
of a single option, so that the choice is still made and told. Architectures stay optional, as connections lead into
them, and so do parts whose connections replace others; a constraint says that they are there. A constraint that
mentions what is gone is rewritten to say the same without it, and left out if that is nothing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

from dse.domain.design import Alternative, Compound, Connection, Constraint, DesignSpace, Node, Optional, Part
from dse.domain.labels import wholes
from dse.errors import Problem, closest, fail, raise_if_any
from dse.expression import parse_expression
from dse.space.decisions import Choices, alternatives, decisions, made
from dse.space.restriction.rewriting import rewritten_constraints

Subset = Mapping[str, Collection[str | None]]
"""What may still be chosen, by the path of the decision; None is leaving the part out. Other decisions stay open."""


def refine(space: DesignSpace, subset: Subset) -> DesignSpace:
    """*space* with the choices of *subset* only.

    Its configurations are those of *space* that choose nothing else, with the same ids. Raises DseError for a decision
    or choice that *space* does not have, and if no design is left.
    """
    raise_if_any(_unknown(space, subset))
    pruner = _Pruner(subset)
    root = pruner.compound(space.root, "", ())
    if root is None:
        raise fail(f"nothing is left of '{space.name}'", space.where, "allow one more choice")
    refined = replace(space, root=root, constraints=(), all_constraints=())
    everything = rewritten_constraints(space, refined)
    off = {constraint.name for constraint in space.all_constraints} - {c.name for c in space.constraints}
    everything += tuple(_kept(path, guards, everything) for path, guards in pruner.kept.items())
    constraints = tuple(constraint for constraint in everything if constraint.name not in off)
    return replace(refined, constraints=constraints, all_constraints=everything)


def spanned(space: DesignSpace, chosen: Iterable[Choices]) -> dict[str, frozenset[str | None]]:
    """The smallest subset that has all configurations of these complete choices in it."""
    found: dict[str, set[str | None]] = {path: set() for path in alternatives(space)}
    tree = decisions(space)
    for choices in chosen:
        for decision, branch in made(tree, choices.get):
            found[decision.path].add(branch.choice if branch else None)
    return {path: frozenset(kept) for path, kept in found.items() if kept}


def _unknown(space: DesignSpace, subset: Subset) -> Iterable[Problem]:
    possible = alternatives(space)
    for path, choices in subset.items():
        if path not in possible:
            yield Problem(f"there is no decision '{path}' in '{space.name}'", space.where, closest(path, possible))
            continue
        for choice in choices:
            if choice is None and None not in possible[path]:
                yield Problem(f"'{path}' cannot be left out", space.where, "it is not optional")
            elif choice not in possible[path]:
                names = [name for name in possible[path] if name is not None]
                yield Problem(f"'{choice}' cannot be chosen for '{path}'", space.where, closest(str(choice), names))


def _kept(path: str, guards: Collection[str], others: Collection[Constraint]) -> Constraint:
    """The constraint that the part at *path* is there, wherever one of *guards* says that it may be."""
    taken = {constraint.name for constraint in others}
    name = f"keep_{path.replace('.', '_')}"
    while name in taken:
        name += "_"
    there = f"{path} is present"
    rule = there if "" in guards else f"{' or '.join(f'({guard})' for guard in sorted(guards))} implies {there}"
    return Constraint(name, parse_expression(rule), "chosen when the design was refined")


class _Pruner:
    """Takes away what *subset* does not have.

    *kept* are the optional parts that must be there and stay optional, with the conditions under which they may be,
    "" for always.
    """

    def __init__(self, subset: Subset) -> None:
        self.subset = subset
        self.kept: dict[str, set[str]] = {}
        self.replacing: set[str] = set()

    def compound(self, compound: Compound, path: str, guards: tuple[str, ...]) -> Compound | None:
        """What is left of a compound that is there if *guards* hold; None if a part that must be there cannot."""
        parts: dict[str, Node] = {}
        self.replacing |= {f"{path}.{name}" if path else name for name in _replacing(compound.connections)}
        for name, child in compound.parts.items():
            here = f"{path}.{name}" if path else name
            left = self.node(child, here, guards)
            if left is not None:
                parts[name] = left
            elif not (isinstance(child, Optional) and self.may_miss(here)):
                return None
        if all(parts.get(name) is child for name, child in compound.parts.items()):
            return compound
        refined = replace(compound, parts=parts)
        connections = tuple(c for c in compound.connections if not _is_cut(c, compound, refined))
        return replace(refined, connections=connections)

    def node(self, node: Node, path: str, guards: tuple[str, ...]) -> Node | None:
        match node:
            case Part():
                return node
            case Compound():
                return self.compound(node, path, guards)
            case Alternative():
                return self.alternative(node, path, guards)
        content = node.content
        if isinstance(content, Part | Compound) and content.name not in self.subset.get(path, (content.name,)):
            return None
        left = self.node(content, path, (*guards, f"{path} is present"))
        if left is None:
            return None
        if not self.may_miss(path):
            if not isinstance(left, Compound) and path not in self.replacing:
                return Alternative((left,), node.where) if isinstance(left, Part) else left
            self.kept.setdefault(path, set()).add(" and ".join(guards))
        return node if left is content else replace(node, content=left)

    def alternative(self, node: Alternative, path: str, guards: tuple[str, ...]) -> Alternative | None:
        options = []
        for option in node.options:
            if option.name not in self.subset.get(path, (option.name,)):
                continue
            below = (*guards, f"{path} is {option.name}")
            left = option if isinstance(option, Part) else self.compound(option, path, below)
            if left is not None:
                options.append(left)
        if len(options) == len(node.options) and all(a is b for a, b in zip(options, node.options, strict=True)):
            return node
        return replace(node, options=tuple(options)) if options else None

    def may_miss(self, path: str) -> bool:
        return None in self.subset.get(path, (None,))


def _replacing(connections: Collection[Connection]) -> Iterable[str]:
    """The names that begin the connections to what others lead to as well."""
    targets = Counter(connection.target for connection in connections)
    groups = {whole for target in targets for whole in wholes(target)}
    for connection in connections:
        target = connection.target
        if targets[target] > 1 or target in groups or any(whole in targets for whole in wholes(target)):
            yield connection.source.partition(".")[0]


def _is_cut(connection: Connection, before: Compound, after: Compound) -> bool:
    """Whether a part that an end of *connection* is at is gone."""
    ends = (connection.source, connection.target, *(connection.when or ())[:1])
    return any(_leads_nowhere(end, before, after) for end in ends)


def _leads_nowhere(end: str, before: Compound, after: Compound) -> bool:
    for step in end.split("."):
        if step not in before.parts:
            return False
        if step not in after.parts:
            return True
        old, new = _inner(before.parts[step]), _inner(after.parts[step])
        if not isinstance(old, Compound) or not isinstance(new, Compound):
            return False
        before, after = old, new
    return False


def _inner(node: Node) -> Node:
    """What an end of a connection sees: an optional part, and one that has become the only alternative, is itself."""
    if isinstance(node, Optional):
        return _inner(node.content)
    return node.options[0] if isinstance(node, Alternative) and len(node.options) == 1 else node
