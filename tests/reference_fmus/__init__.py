"""FMUs for the tests that are archives as any tool would write them: seven models, FMI 1.0, 2.0 and 3.0."""

from reference_fmus.build import build
from reference_fmus.models import MODELS

__all__ = ["MODELS", "build"]
