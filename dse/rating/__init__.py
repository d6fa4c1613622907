"""Points of a rating protocol, predicted by simulation: tests on benches, and the protocol's own calculator."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
