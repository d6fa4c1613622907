"""FMUs from C that a kind writes by itself."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from dse.domain.component import Component, CSource


def build_generated(
    component: Component,
    files: Mapping[str, str],
    struct: str,
    step: float | None = None,
    *,
    version: int,
    cache: Path | None,
    partner: str = "",
    resources: Mapping[str, bytes] | None = None,
    is_live: bool = False,
    is_coded: bool = False,
) -> Path:
    """The FMU archive of *component* from C as the kind ``c`` takes it, which *files* has by file name.

    There is ``<struct>.h``, which defines the type *struct*, ``<struct>_init`` and ``<struct>_step``; with *step* the
    code is sampled. What is built so can be fused, unless the module *partner* does the work, with *resources*, or it
    *is_live*: somebody outside does. The files are kept in the folder *cache*. Raises DseError.
    """
    from dse.cache import cache_folder, content_key, keep_files
    from dse.fmu import build_c

    contents = {name: text.encode() for name, text in sorted(files.items())}
    folder = keep_files(cache_folder(cache) / "generated" / content_key(contents.items()), lambda: contents)
    held = tuple(sorted((resources or {}).items()))
    paths = tuple(folder / name for name in contents)
    source = CSource(
        paths,
        folder / f"{struct}.h",
        struct,
        f"{struct}_init",
        f"{struct}_step",
        step,
        partner,
        held,
        is_live,
        is_coded,
    )
    return build_c(component, source, version=version, cache=cache)
