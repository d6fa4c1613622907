"""What the runs of a study tell: what matters, how sure that is, where requirements are met. Nothing is simulated."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
