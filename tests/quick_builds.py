"""FMUs without the optimizer, for tests that build hundreds of them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from dse.fmu.toolchain import compilation


@contextmanager
def unoptimized() -> Iterator[None]:
    """What is compiled meanwhile is so without the optimizer, which takes three quarters of the time."""
    quick = tuple("-O0" if option == "-O2" else option for option in compilation.LANGUAGE_OPTIONS)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compilation, "LANGUAGE_OPTIONS", quick)
        yield
