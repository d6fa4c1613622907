"""The graph of a design space as data, and its picture as XML."""

from __future__ import annotations

import pytest
from defusedxml import ElementTree

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Constraint, DesignSpace, Optional, Part
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.pictures.tree import draw_tree
from dse.pictures.tree_layout import NodeKind, lay_out
from dse.space.methods.engine import Engine
from dse.space.output.tree import ONE_OF, part_below, tree_of
from dse.space.questions.occurrence import dead_branches


def part(name):
    return Part(Component(name, Interface("any", ())))


HYBRID = Compound("hybrid", {"engine": Alternative((part("d"), part("e"))), "box": part("f")})
PARTS = {
    "s": Alternative(tuple(part(f"s{i}") for i in range(9))),
    "o": Optional(Alternative((part("x"), part("y")))),
    "v": Optional(part("w")),
    "p": Alternative((part("bev"), HYBRID)),
}


def space(*rules, name="car"):
    constraints = tuple(Constraint(rule, parse_expression(rule)) for rule in rules)
    return DesignSpace(name, Compound(name, PARTS), constraints)


def labels(tree, **wanted):
    return [node.label for node in tree.all() if all(getattr(node, key) == value for key, value in wanted.items())]


def test_the_graph_is_a_tree_of_containers_in_the_order_of_the_file():
    tree = tree_of(space())
    assert labels(tree, kind=NodeKind.COMPOUND) == ["car", "hybrid"]
    assert labels(tree, kind=NodeKind.ALTERNATIVE) == ["s", ONE_OF, "p", "engine"]
    assert labels(tree, kind=NodeKind.OPTIONAL) == ["o", "v"]
    assert labels(tree, kind=NodeKind.COMPONENT)[-4:] == ["bev", "d", "e", "box: f"]
    assert [node.label for node in tree.below] == ["s", "o", "v", "p"]


def test_what_is_chosen_is_marked_from_the_root_down():
    tree = tree_of(space(), {"s": "s3", "o": "y", "p": "hybrid", "p.engine": "e"})
    chosen = ["car", "s", "s3", "o", ONE_OF, "y", "p", "hybrid", "engine", "e", "box: f"]
    assert labels(tree, chosen=True) == chosen
    assert labels(tree_of(space()), chosen=None) == labels(tree_of(space()))


def test_what_no_configuration_has_is_dead_with_all_below_it():
    constrained = space("p is not hybrid", "s in [s0, s1, s2]", "o is not y")
    tree = tree_of(constrained, None, dead_branches(Engine.of(constrained)))
    assert labels(tree, dead=True) == ["s3", "s4", "s5", "s6", "s7", "s8", "y", "hybrid", "engine", "d", "e", "box: f"]


def test_a_part_of_the_graph_is_what_stands_below_a_place():
    assert labels(part_below(tree_of(space()), "p")) == ["p", "bev", "hybrid", "engine", "d", "e", "box: f"]
    with pytest.raises(DseError, match=r"no place 'p\.engin'") as caught:
        part_below(tree_of(space()), "p.engin")
    assert "p.engine" in str(caught.value)


TALL = DesignSpace("tall", Compound("tall", {f"u{i}": Compound(f"u{i}", PARTS) for i in range(9)}))


@pytest.mark.parametrize("drawn", [space(), TALL])
def test_no_two_nodes_of_a_layout_overlap(drawn):
    layout = lay_out(tree_of(drawn))
    boxes = list(layout.boxes.values())
    assert len(boxes) == len(list(tree_of(drawn).all()))
    for number, one in enumerate(boxes):
        assert one.x >= 0
        assert one.top >= 0
        assert one.right <= layout.width
        for other in boxes[number + 1 :]:
            apart = one.right <= other.x or other.right <= one.x
            assert apart or abs(one.middle - other.middle) >= (one.height + other.height) / 2


def test_a_tall_space_stands_in_columns():
    tree = tree_of(TALL)
    layout = lay_out(tree)
    assert len({layout.boxes[node].x for node in tree.below}) > 1
    assert layout.height < 2 * layout.width
    assert not lay_out(tree_of(space())).gutters


def test_the_picture_is_well_formed_whatever_things_are_called():
    rude = DesignSpace("<&\"'>", Compound("<script>", {"a&b": Alternative((part("]]>"), part("x<y")))}))
    picture = ElementTree.fromstring(draw_tree(tree_of(rude, {"a&b": "x<y"}), "<title> & more", '"note"'))
    texts = [element.text for element in picture.iter("{http://www.w3.org/2000/svg}text")]
    assert {"<title> & more", '"note"', "<&\"'>", "a&b", "]]>", "x<y"} <= set(texts)


def test_alternatives_are_dashed_and_the_chosen_path_is_highlighted():
    picture = draw_tree(tree_of(space(), {"s": "s3", "p": "bev"}), "car")
    root = ElementTree.fromstring(picture)
    classes = [element.get("class", "") for element in root.iter()]
    assert classes.count("alternative edge chosen") == 2
    assert classes.count("component chosen") == 1 + 2
    assert draw_tree(tree_of(space(), {"s": "s3", "p": "bev"}), "car") == picture


def test_a_graph_too_large_to_read_is_refused_by_name():
    parts = {f"p{i}": Alternative((part("a"), part("b"))) for i in range(1000)}
    large = DesignSpace("large", Compound("large", parts))
    with pytest.raises(DseError, match="'large' has 3,001 nodes") as caught:
        draw_tree(tree_of(large), "large")
    assert "--below" in str(caught.value)
    assert draw_tree(part_below(tree_of(large), "p7"), "p7")
