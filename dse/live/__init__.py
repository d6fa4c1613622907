"""Runs that talk with somebody outside while they go on: packets, and the processes at their ends."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
