"""Reads where a component's behaviour comes from."""

from __future__ import annotations

from pathlib import Path

from dse.domain.component import CSource, FmuSource, Source, UnsupportedSource
from dse.errors import Location, closest, fail
from dse.loading.documents import ComponentFile, SourceSection
from dse.loading.names import is_identifier
from dse.loading.root import followed, is_file, named_file
from dse.loading.values import read_number, read_unit
from dse.loading.yaml import Document, shown

_KINDS = ("c", "fmu")
_PLANNED = ("modelica", "python", "udp")


def read_source(document: Document, file: ComponentFile, section: SourceSection, inside: Path) -> Source:
    """Where the behaviour of the component comes from; its C files lie in *inside*. Raises DseError."""
    folder = document.path.parent
    if section.kind == "fmu":
        if section.file is None:
            raise fail("'file' is missing in 'source'", document.key(("source",)), "file: my_part.fmu")
        where = document.place(("source", "file"))
        # Used as it is and known by its content, so that it may lie anywhere.
        return FmuSource(_existing(followed(folder, section.file, where), where))
    if section.kind != "c":
        where = document.place(("source", "kind"))
        if section.kind in _PLANNED:
            return UnsupportedSource(section.kind)
        raise fail(f"unknown kind of source '{section.kind}'", where, closest(section.kind, (*_KINDS, *_PLANNED)))
    if not section.files:
        raise fail("'files' is missing in 'source'", document.key(("source",)), f"files: [{file.component}.c]")
    files = tuple(
        _c_file(folder, name, inside, (".c", ".h"), document.place(("source", "files", i)))
        for i, name in enumerate(section.files)
    )
    header = section.header or Path(section.files[0]).with_suffix(".h").as_posix()
    struct = section.struct or file.component
    step = None
    if section.step is not None:
        where = document.place(("source", "step"))
        step = read_number(section.step, read_unit("s", where), where)
        if step <= 0:
            raise fail(f"the step must be positive, not {section.step}", where)
    return CSource(
        files,
        _c_file(folder, header, inside, (".h",), document.place(("source", "header"))),
        _identifier(struct, document.place(("source", "struct"))),
        _identifier(section.init or f"{struct}_init", document.place(("source", "init"))),
        _identifier(section.step_function or f"{struct}_step", document.place(("source", "step_function"))),
        step,
    )


def _c_file(folder: Path, name: str, inside: Path, suffixes: tuple[str, ...], where: Location) -> Path:
    return _existing(named_file(folder, name, inside, suffixes, where), where)


def _existing(path: Path, where: Location) -> Path:
    if not is_file(path):
        raise fail(f"no such file: {shown(path)}", where, "paths are relative to this component.yaml")
    return path


def _identifier(name: str, where: Location) -> str:
    if not is_identifier(name):
        raise fail(f"'{name}' is not a C identifier", where)
    return name
