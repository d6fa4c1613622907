"""The expression language of constraints, metrics and conditions: read, checked for units, written again."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
