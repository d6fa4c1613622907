"""Component kinds, one a module: how each is written in a component.yaml and becomes an FMU.

A kind of one's own takes what it needs from `dse.plugins`; `dse.testing.kinds` has the tests it has to pass.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
