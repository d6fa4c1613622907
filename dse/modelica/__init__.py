"""Modelica becomes C: a front-end in a process of its own, flattening, structure, code."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
