"""A study is explored: a sampler asks for runs, an executor has them made, the study folder keeps them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
