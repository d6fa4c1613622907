"""The cache folder: what may be kept between two commands, and may always be thrown away.

An entry is a file or a folder that stands under its key. Beside it lies the digest of what was kept: an entry that
does not match it any more is made again when it is used next, and a warning says so.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
