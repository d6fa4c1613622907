"""What a page needs to simulate by itself: a WebAssembly module, how to run it, and the worker that does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from dse.report.page.encoding import packed_text
from dse.report.page.payload import script_json

_ELEMENTS = """
<script type="application/octet-stream;base64" id="simulation">{document}</script>
<script type="application/octet-stream;base64" id="module">{module}</script>
<script type="text/plain" id="worker">{worker}</script>"""

POLICY = (" 'wasm-unsafe-eval'", "; worker-src blob:")
"""What a page that simulates is allowed besides: among its scripts, and among its directives."""


@dataclass(frozen=True, slots=True)
class PageSimulation:
    """*module* simulates the configurations that *document* (plain data) describes, as web/src/simulate/document.ts
    reads it."""

    document: Mapping[str, Any]
    module: bytes

    def elements(self, worker: str) -> str:
        """The elements of the page, with the script of its *worker*."""
        document = packed_text(script_json(self.document).encode())
        return _ELEMENTS.format(document=document, module=packed_text(self.module), worker=worker)
