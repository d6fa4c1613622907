"""Component kinds, one a module: how each is written in a component.yaml and becomes an FMU.

A kind of one's own takes what it needs from here; `dse.testing.kinds` has the tests it has to pass.
"""

from dse.domain.component import Component, CSource, Source
from dse.kinds._generated import build_generated
from dse.loading.component.kind import ComponentKind, SourcePlace, SourceSection

__all__ = ["CSource", "Component", "ComponentKind", "Source", "SourcePlace", "SourceSection", "build_generated"]
