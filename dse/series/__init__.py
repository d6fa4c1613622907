"""Time series: columns of CSV, Parquet and MDF files as checked samples in SI, and as C that gives them over time."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
