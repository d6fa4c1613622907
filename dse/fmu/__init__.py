"""FMUs read and built: descriptions of FMI 1, 2 and 3, components in C, whole benches in one library."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
