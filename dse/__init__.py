"""A workbench for designing cyber-physical products when architecture and numbers are both open.

What this package exports (``dse.__all__``) is public: docs/python.md shows it; so are `dse.plugins` and `dse.testing`,
for packages that add to it. Everything else is private and may change from one version to the next. Nothing is imported
before it is used.
"""

__version__ = "0.2.0"


def __getattr__(name: str) -> object:
    import sys

    import lazy_loader  # not before: the command line must not be interrupted before it can say so

    here = sys.modules[__name__]
    here.__getattr__, here.__dir__, here.__all__ = lazy_loader.attach_stub(__name__, __file__)  # this is called once
    return getattr(here, name)


def __dir__() -> list[str]:
    return [*__getattr__("__all__")]
