"""The co-simulation master: wired FMUs become tables that a kernel in C runs; what stopped a run is put in words."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
