"""Large models are compiled in parts: every pass still computes everything once, in an order that works."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import pytest
from emitted_model import Emitter
from hypothesis import given, settings, strategies as st
from model_maker import Maker, explicit

from dse.modelica.algebra.expression import Graph
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import symbols
from dse.modelica.emit.sharing import Part, Passes, shared_passes
from dse.modelica.flat_model import FlatModel, Role, Trigger
from dse.modelica.solved_model import Activation, Block, EventBlock, Explicit, When, expressions, targets

_COUNT = 110


def flattened(program: Iterable[Part | EventBlock]) -> list[EventBlock]:
    return [block for item in program for block in (item.blocks if isinstance(item, Part) else (item,))]


def unmet(order: Sequence[EventBlock], known: set[Symbol], flat: FlatModel) -> list[Symbol]:
    """What a block of *order* reads before it is there."""
    wrong = []
    for block in order:
        wrong += [s for value in expressions(block, flat) for s in symbols(value) if s not in known]
        known |= set(targets((block,)))
    return wrong


Recipe = list[tuple[bool, list[int]]]
_RECIPES: st.SearchStrategy[Recipe] = st.lists(
    st.tuples(st.booleans(), st.lists(st.integers(0, 30), min_size=1, max_size=3)),
    min_size=_COUNT,
    max_size=_COUNT,
)


def planned(recipe: Recipe) -> tuple[Passes, list[Block], list[Block], list[EventBlock], list[EventBlock], FlatModel]:
    """Variables x0, x1, … of which each needs earlier ones; some are discrete, and the last third are outputs."""
    graph = Graph()
    blocks: list[EventBlock] = []
    for number, (is_discrete, steps) in enumerate(recipe):
        value = graph.variable("state")
        for step in steps:
            value = value + (graph.variable(f"x{number - 1 - step}") if step < number else graph.variable("input"))
        symbol = Symbol(f"x{number}")
        is_when = is_discrete and number % 5 == 4
        blocks.append(When(symbol, ((None, value),)) if is_when else Explicit(symbol, value))
    flat = FlatModel("Random", graph, {}, (), triggers=(Trigger((graph.variable("x3"),)),))
    continuous = [block for block in blocks if isinstance(block, Explicit)]
    two_thirds = 2 * len(continuous) // 3
    derivatives: list[Block] = [*continuous[:two_thirds]]
    outputs: list[Block] = [*continuous[two_thirds:]]
    event = [*blocks, Activation(0)]
    initial: list[EventBlock] = [explicit("state", graph.variable("input")), *blocks]
    return shared_passes(derivatives, outputs, event, initial, flat), derivatives, outputs, event, initial, flat


@given(_RECIPES)
@settings(max_examples=40, deadline=None)
def test_every_pass_has_all_its_blocks_once_and_in_an_order_that_works(recipe: Recipe) -> None:
    made, derivatives, outputs, event, initial, flat = planned(recipe)
    given_first = {Symbol("input"), Symbol("state")}
    discrete = {block.target for block in event if isinstance(block, When)}
    assert made.initial is not None
    for program, blocks, known in (
        (made.derivatives, derivatives, given_first | discrete),
        (made.outputs, outputs, given_first | discrete | set(targets(derivatives))),
        (made.event, event, set(given_first)),
        (made.initial, initial, {Symbol("input")}),
    ):
        order = flattened(program)
        assert sorted(map(id, order)) == sorted(map(id, blocks))
        assert unmet(order, set(known), flat) == []


def test_a_large_model_is_split_and_computes_the_same_in_every_pass(emitted: Emitter) -> None:
    made = Maker()
    graph = made.graph
    x, u = made.variable("x"), made.variable("u", Role.INPUT)
    d = made.variable("d", Role.DISCRETE)
    made.states.append(Symbol("x"))
    blocks: list[Explicit] = []
    for number in range(40):
        early = made.variable(f"a{number}")
        blocks.append(explicit(f"a{number}", x * float(number) + (graph.variable(f"a{number - 1}") if number else u)))
    for number in range(60):
        made.variable(f"b{number}")
        blocks.append(explicit(f"b{number}", graph.make("sin", early + d * float(number + 1))))
    slope = explicit("x", graph.variable("b59") - x, 1)
    made.put("derivatives", *blocks, slope)
    discrete = When(Symbol("d"), ((None, graph.make("floor", graph.variable("a39"))),))
    made.put("event", *blocks[:40], discrete, *blocks[40:], slope)
    made.put("initial", explicit("x", graph.constant(0.5)), *blocks[:40], discrete, *blocks[40:], slope)
    model = emitted(made.solved())
    text = model.files["model.h"].decode()
    assert text.count("sin(") == 60  # compiled once, not for every pass
    found = []
    for names in (("initial",), ("event",), ("derivatives",)):
        model.set({Symbol("u"): 1.25, Symbol("x"): 0.5})
        for name in names:
            assert model.call(name) == 0
        found.append([model.get(Symbol("x", 1)), model.get(Symbol("d")), model.get(Symbol("b17"))])
    assert found[0] == found[1] == found[2]
    assert found[0][1] == 0.5 * sum(range(40)) + 1.25 - 0.25  # floor of the quarter


def test_a_small_model_stays_in_one_piece() -> None:
    graph = Graph()
    block = explicit("y", graph.variable("u"))
    made = shared_passes((block,), (), (block,), (block,), FlatModel("Small", graph, {}, ()))
    assert made.parts == ()
    assert made.event == made.derivatives == (block,)


@pytest.mark.parametrize("missing", ["event", "initial"])
def test_a_pass_that_computes_something_in_another_way_shares_nothing(missing: str) -> None:
    graph = Graph()
    blocks = tuple(explicit(f"x{number}", graph.variable("u") + float(number)) for number in range(_COUNT))
    other = (*blocks[1:], explicit("x0", graph.variable("u") * 2.0))
    event, initial = (other, blocks) if missing == "event" else (blocks, other)
    made = shared_passes(blocks, (), event, initial, FlatModel("Other", graph, {}, ()))
    assert made.initial is None
    assert flattened(made.event) == list(event)
