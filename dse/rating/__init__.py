"""Ratings and test procedures by simulation: tests on benches, and the calculator of a rating protocol."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
