from .component import draw_component as draw_component, pictured as pictured
from .component_layout import ComponentLayout as ComponentLayout, lay_out as lay_out
from .tree import draw_tree as draw_tree
from .tree_layout import NodeKind as NodeKind, TreeNode as TreeNode
