"""Studies in the browser: a server that shows what is in study folders, also while they are explored."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
