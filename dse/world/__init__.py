"""Roads: OpenDRIVE and its shorthand, read into the tables that the world's C core interprets."""

import lazy_loader as lazy

__getattr__, __dir__, __all__ = lazy.attach_stub(__name__, __file__)
