"""The front door: what a notebook and the command line share. ``import dse`` offers it to people.

Objects are thin: they hold the nouns of `dse.domain` and call what answers. Each module imports what it needs when it
is asked, so that asking a design space does not wait for what simulates.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
