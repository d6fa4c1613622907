"""Files of other programs as files of a workspace."""

from __future__ import annotations

from dse.testbench.importing import import_component
from dse.testbench.ssp_import import import_ssp

__all__ = ["import_component", "import_ssp"]
