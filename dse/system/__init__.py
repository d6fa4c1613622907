"""Components that are wired, with their FMUs, become a system: names bound, units and sizes checked."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
