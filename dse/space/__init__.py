"""Design spaces: lowered to rules and sums once, then counted, listed, drawn from, optimized and explained."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
