"""A workbench for designing cyber-physical products when architecture and numbers are both open.

What this package exports (``dse.__all__``) is public: docs/python.md shows it; so are `dse.plugins` and `dse.testing`,
for packages that add to it. Everything else is private and may change from one version to the next. Nothing is imported
before it is used.
"""

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
