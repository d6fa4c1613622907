from .component import draw_component as draw_component, pictured as pictured
from .tree import draw_tree as draw_tree
from .tree_layout import NodeKind as NodeKind, TreeNode as TreeNode
