"""Exact counts under sums, on grids over the nodes of a diagram."""
