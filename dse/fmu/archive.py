"""The zip file that is an FMU, written so that the same contents are the same bytes."""

from __future__ import annotations

from collections.abc import Mapping

from dse.formats.zipped import pack_zip


def pack(contents: Mapping[str, bytes]) -> bytes:
    """A zip archive of *contents* by path: sorted names, no clock, and stored plainly."""
    return pack_zip(contents)
