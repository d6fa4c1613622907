"""``dse space``: questions about a design space."""

from __future__ import annotations

from dse.cli.app import group

space_app = group("space", "Ask about a design space.")
