"""The YAML and UVL a user writes become nouns, every problem with its place; and nouns become YAML again."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
