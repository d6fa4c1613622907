"""Whether SUMO is installed; in CI it must be."""

import importlib.util
import os

import pytest

IS_HERE = all(importlib.util.find_spec(name) for name in ("libsumo", "sumo"))

needs_sumo = pytest.mark.skipif(
    not IS_HERE and not os.environ.get("CI"), reason="SUMO is not installed: pip install 'dse-workbench[traffic]'"
)
