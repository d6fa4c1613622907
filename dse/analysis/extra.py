"""What is installed by the extra ``analysis`` only."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from dse.errors import fail


def extra(module: str, whose: str) -> Any:
    """A module of the package *whose*; DseError that says how to install it."""
    try:
        return import_module(module)
    except ImportError as error:
        hint = 'pip install "dse-workbench[analysis]"'
        raise fail(f"{whose} is needed for this, and is not installed", None, hint) from error
