"""A study folder becomes one page to decide with, and figures for print. Nothing is simulated."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
