"""A configuration on its test bench becomes something that runs, and a run of it numbers and verdicts."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
