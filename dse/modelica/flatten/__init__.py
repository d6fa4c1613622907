"""Front-end JSON in, `FlatModel` out: strictly read, arrays scalarised, functions inlined, events made explicit."""

from dse.modelica.flatten.flattening import flatten

__all__ = ["flatten"]
