"""Every valid row, in order, by walking the diagram or by complete search."""
