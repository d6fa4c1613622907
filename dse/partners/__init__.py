"""Processes that do the work of FMUs (dse/fmu/runtime/partner.h): the line to the importer, and classes in Python."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
