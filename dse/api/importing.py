"""Files of other programs as files of a workspace."""

from __future__ import annotations

from dse.interchange.importing.component import import_component
from dse.interchange.importing.ssp import import_ssp

__all__ = ["import_component", "import_ssp"]
