"""Random spaces for the tests of questions, and the answers by brute force."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import HealthCheck, assume, settings, strategies as st
from random_spaces import bare_space, condition, design_spaces, rows_of, spelled_out

from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Node, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.space.decisions import sites
from dse.space.flat import Rows
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places
from dse.space.methods.engine import Engine

EXAMPLES = settings(deadline=None, max_examples=25, suppress_health_check=list(HealthCheck))
SMALL = 200


@dataclass(frozen=True, repr=False)
class Answers:
    """All combinations of a space, and whether they meet each constraint; shape (combinations, constraints)."""

    space: DesignSpace
    engine: Engine
    rows: Rows
    choices: list[dict[str, str]]
    holds: np.ndarray

    def __repr__(self) -> str:
        """Short, as hypothesis prints it: the places, what they may hold, and the rules."""
        places = [f"{variable.path}={'|'.join(map(str, variable.values))}" for variable in self.engine.flat.variables]
        return "; ".join([*places, *(constraint.rule.text for constraint in self.space.constraints)])[:2000]

    def valid(self) -> np.ndarray:
        return self.holds.all(axis=1)


def answers(space: DesignSpace) -> Answers:
    """Spaces in which some value does not exist are not looked at here."""
    try:
        engine = Engine.of(space)
    except DseError:
        assume(False)
        raise
    rows = rows_of(engine.flat)
    choices = [engine.flat.choices(row) for row in rows]
    places = Places(space)
    texts = [spelled_out(constraint.rule.text, space) for constraint in space.constraints]
    rules = [compile_in(parse_expression(text), places) for text in texts]
    try:
        outcomes = [[rule.outcome(chosen) is not False for rule in rules] for chosen in choices]
    except DseError:
        assume(False)
        raise
    return Answers(space, engine, rows, choices, np.array(outcomes, bool).reshape(len(rows), len(rules)))


@st.composite
def asked(draw: st.DrawFn, most_constraints: int = 4) -> Answers:
    return answers(draw(design_spaces(most_constraints, SMALL)))


@st.composite
def related(draw: st.DrawFn) -> tuple[Answers, Answers]:
    """Two spaces over similar trees: parts dropped, added, exchanged; some constraints the same."""
    one = draw(design_spaces(2, SMALL))
    other = bare_space(draw, SMALL)
    root = _mutated(draw, one.root, other.root)
    assert isinstance(root, Compound)
    bare = DesignSpace("other", root)
    texts = [constraint.rule.text for constraint in one.constraints if draw(st.booleans())]
    if any(sites(bare)):
        texts += [condition(draw, bare) for _ in range(draw(st.integers(0, 2)))]
    constraints = []
    for number, text in enumerate(texts):
        expression = parse_expression(text)
        try:
            compile_in(expression, Places(bare))
        except DseError:
            continue
        constraints.append(Constraint(f"d{number}", expression))
    assume(len(rows_of(Engine.of(bare).flat)) <= 10 * SMALL)
    return answers(one), answers(replace(bare, constraints=tuple(constraints), all_constraints=()))


def _mutated(draw: st.DrawFn, node: Node, other: Node) -> Node:
    action = draw(st.integers(0, 7))
    match node:
        case Compound():
            foreign = other.parts if isinstance(other, Compound) else {}
            parts = {}
            for name, child in node.parts.items():
                if draw(st.integers(0, 6)) or len(node.parts) == 1:
                    parts[name] = _mutated(draw, child, foreign.get(name, other))
            for name, child in foreign.items():
                if name not in parts and not draw(st.integers(0, 3)):
                    parts[name] = child
            return replace(node, parts=parts)
        case Alternative():
            options = [
                mutated
                for option in node.options
                if draw(st.integers(0, 4)) and isinstance(mutated := _mutated(draw, option, other), Part | Compound)
            ]
            if draw(st.booleans()):
                options.reverse()
            changed = Alternative(tuple({option.name: option for option in options or node.options}.values()))
            return Optional(changed) if not action else changed
        case Optional():
            content = _mutated(draw, node.content, other)
            return content if not action or isinstance(content, Optional) else Optional(content)
    return Optional(node) if not action else node


def same_choices(found: Mapping[str, str], wanted: Mapping[str, str]) -> bool:
    return dict(found) == dict(wanted)


class _Undiagrammed(Engine):
    diagram = None


def without_diagram(engine: Engine) -> Engine:
    """The same questions, put to what answers where no diagram fits."""
    return _Undiagrammed(engine.flat)


def listed(engine: Engine) -> Iterator[tuple[int, ...]]:
    return (tuple(row) for block in engine.blocks() for row in block.tolist())
