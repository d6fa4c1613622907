"""The tree of a design space as an SVG picture, and what is chosen in it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape

from dse.errors import fail
from dse.pictures.svg import Box, curve, labelled, rectangle, sheet
from dse.pictures.tree_layout import NodeKind, TreeLayout, TreeNode, lay_out

MOST_NODES = 3000
"""Nodes of the largest tree that is drawn: more could not be read."""

_MARGIN = 24.0
_HEAD = 74.0
_LEAST_WIDTH = 760.0
_CURVE = 0.55

_STYLE = """
.title { font-size: 17px; font-weight: 600; }
.note { fill: #5b6875; }
.edge { fill: none; stroke: #8b98a5; stroke-width: 1.3; }
.alternative.edge { stroke-dasharray: 5 4; }
.frame { fill: #f7f9fb; stroke: #8b98a5; stroke-width: 1.1; stroke-dasharray: 5 4; }
.compound rect { fill: #2f4358; stroke: #2f4358; }
.compound text { fill: #ffffff; font-weight: 600; }
.alternative rect { fill: #dfe9f3; stroke: #7d93aa; }
.optional rect { fill: #ffffff; stroke: #7d93aa; stroke-width: 1.6; }
.component rect { fill: #ffffff; stroke: #c3ccd5; }
.chosen rect { fill: #f4a300; stroke: #b97700; }
.chosen text { fill: #1c2733; font-weight: 600; }
.compound.chosen rect { fill: #b35c00; stroke: #b35c00; }
.compound.chosen text { fill: #ffffff; }
.chosen.edge { stroke: #d98600; stroke-width: 2.6; }
.passed { opacity: 0.5; }
.dead rect { fill: #eceff1; stroke: #d3d9de; }
.dead text { fill: #98a3ad; font-weight: 400; text-decoration: line-through; }
"""


def draw_tree(tree: TreeNode, title: str, note: str = "") -> str:
    """The tree as SVG. Raises DseError if it has more than `MOST_NODES` nodes."""
    nodes = list(tree.all())
    if len(nodes) > MOST_NODES:
        what = f"'{tree.label}' has {len(nodes):,} nodes; a drawing takes at most {MOST_NODES:,}"
        raise fail(what, None, "draw one part of it: --below PLACE")
    layout = lay_out(tree)
    width = max(layout.width + 2 * _MARGIN, _LEAST_WIDTH)
    height = layout.height + _HEAD + 2 * _MARGIN
    content = [
        f'<text class="title" x="{_MARGIN:.0f}" y="{_MARGIN + 12:.0f}">{escape(title)}</text>',
        f'<text class="note" x="{_MARGIN:.0f}" y="{_MARGIN + 32:.0f}">{escape(note)}</text>',
        *_legend(nodes),
        f'<g transform="translate({_MARGIN:.0f} {_HEAD + _MARGIN:.0f})">',
        *_edges(tree, layout),
        *(rectangle(block.box, 8, ' class="frame"') for block in layout.blocks),
        *(_node(node, layout.boxes[node]) for node in nodes),
        "</g>",
    ]
    return sheet(width, height, title, _STYLE, content)


def _edges(tree: TreeNode, layout: TreeLayout) -> Iterator[str]:
    inside = {member for block in layout.blocks for member in block.members}
    ends: list[tuple[TreeNode, Box, tuple[TreeNode, ...]]] = [
        (above, layout.boxes[node], (node,)) for above in tree.all() for node in above.below if node not in inside
    ]
    ends += [(block.owner, block.box, block.members) for block in layout.blocks]
    # Chosen edges last, so that they lie on top.
    for above, box, nodes in sorted(ends, key=lambda end: _is_chosen(end[2])):
        gutter = layout.gutters.get(nodes[0])
        line = _curve(layout.boxes[above], box) if gutter is None else _turned(layout.boxes[above], box, gutter)
        yield f'<path class="{above.kind} edge{_state(nodes)}" d="{line}"/>'


def _is_chosen(nodes: Sequence[TreeNode]) -> bool:
    return any(node.chosen for node in nodes)


def _state(nodes: Sequence[TreeNode]) -> str:
    """The classes that say whether something is chosen, passed over, or dead."""
    if _is_chosen(nodes):
        return " chosen"
    passed = " passed" if all(node.chosen is False for node in nodes) else ""
    return passed + (" dead" if all(node.dead for node in nodes) else "")


def _curve(start: Box, end: Box) -> str:
    bend = (end.x - start.right) * _CURVE
    return curve(
        (start.right, start.middle), (start.right + bend, start.middle), (end.x - bend, end.middle), (end.x, end.middle)
    )


def _turned(start: Box, end: Box, gutter: float) -> str:
    """Along the top, down at *gutter*, and on to *end*."""
    return f"M{start.right:.1f} {start.middle:.1f} H{gutter:.1f} V{end.middle:.1f} H{end.x:.1f}"


def _node(node: TreeNode, box: Box) -> str:
    said = f"{node.path or 'root'}: {node.kind}" + (", in no valid configuration" if node.dead else "")
    rounding = 10 if node.kind is NodeKind.OPTIONAL else 4
    return labelled(f"{node.kind}{_state([node])}", box, node.label, rounding, f"<title>{escape(said)}</title>")


def _legend(nodes: Sequence[TreeNode]) -> Iterator[str]:
    entries = [(str(kind), str(kind)) for kind in NodeKind]
    if any(node.chosen for node in nodes):
        entries.append(("component chosen", "chosen"))
    if any(node.dead for node in nodes):
        entries.append(("component dead", "in no valid configuration"))
    x, middle = _MARGIN, _MARGIN + 54
    for classes, label in entries:
        width = len(label) * 7.6 + 18
        yield labelled(classes, Box(x, middle, width, 20), label, 10 if classes == NodeKind.OPTIONAL else 4)
        x += width + 10
    yield f'<path class="edge" d="M{x + 8:.1f} {middle:.1f} h30"/>'
    yield f'<text class="note" x="{x + 44:.1f}" y="{middle + 4:.1f}">all of</text>'
    yield f'<path class="alternative edge" d="M{x + 96:.1f} {middle:.1f} h30"/>'
    yield f'<text class="note" x="{x + 132:.1f}" y="{middle + 4:.1f}">one of</text>'
