from .component import (
    ComponentLayout as ComponentLayout,
    draw_component as draw_component,
    lay_out as lay_out,
    pictured as pictured,
)
from .tree import draw_tree as draw_tree
from .tree_layout import NodeKind as NodeKind, TreeNode as TreeNode
