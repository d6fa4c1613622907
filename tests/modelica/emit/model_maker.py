"""Solved models made by hand, block by block."""

from __future__ import annotations

from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.flat_model import FlatModel, Role, ScalarType, Variable
from dse.modelica.solved_model import EventBlock, Explicit, Solved


class Maker:
    """Collects a solved model, its names as they are needed."""

    def __init__(self) -> None:
        self.graph = Graph()
        self.declared: dict[str, Variable] = {}
        self.parts: dict[str, list[EventBlock]] = {"parameters": [], "derivatives": [], "outputs": [], "event": []}
        self.parts |= {"initial": [], "guesses": []}
        self.flat: dict[str, tuple[object, ...]] = {}
        self.states: list[Symbol] = []
        self.aliases: dict[str, tuple[Symbol, int]] = {}

    def parameter(self, name: str, value: float | None = 0.0, **options: object) -> Expression:
        start = None if value is None else self.graph.constant(value)
        self.declared[name] = Variable(name, ScalarType.REAL, Role.PARAMETER, start=start, **options)  # type: ignore[arg-type]  # options of a dataclass
        return self.graph.variable(name)

    def variable(
        self, name: str, role: Role = Role.CONTINUOUS, kind: ScalarType = ScalarType.REAL, **options: object
    ) -> Expression:
        self.declared[name] = Variable(name, kind, role, **options)  # type: ignore[arg-type]  # options of a dataclass
        return self.graph.variable(name)

    def put(self, part: str, *blocks: EventBlock) -> None:
        self.parts[part] += blocks

    def solved(self) -> Solved:
        flat = FlatModel("Made", self.graph, self.declared, (), **self.flat)  # type: ignore[arg-type]  # options of a dataclass
        parts = {name: tuple(blocks) for name, blocks in self.parts.items()}
        return Solved(flat, tuple(self.states), aliases=self.aliases, dependencies={}, **parts)  # type: ignore[arg-type]  # as above


def explicit(name: str, value: Expression, order: int = 0) -> Explicit:
    return Explicit(Symbol(name, order), value)
