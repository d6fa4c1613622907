from ._generated import build_generated as build_generated
from .fmu import FmuSource as FmuSource
