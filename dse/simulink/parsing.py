"""Runs in a Python of its own, without the rest of dse: reads headers by libclang, which may crash, hang or grow.

On stdin is one request, ``{"clang": folder of the package, "headers": names, "options": [words], "folders": [paths],
"is_cpp": bool}``; on stdout comes one answer, ``{"wrong": [[what, file, line,
column]]}`` or the tables that declarations.py reads. A type is its place in the table ``types``, behind those within.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from clang.cindex import Cursor, Type

_MOST_MEMORY = 4 * 1024**3
_MOST_SECONDS = 60
_MOST_TOLD = 5
_MOST_DECLARED = 200_000
_LONGEST_NAME = 1000
_DEEPEST = 64
"""Types within types: arrays of pointers to arrays … of structs that point to structs."""

_LONGEST_COMMENT = 400
_COMMENT = re.compile(rb"[\s\[\]\w]*?;\s*(?:/\*(.*?)(?:\*/|\Z)|//([^\n]*))", re.DOTALL)


class _Refused(Exception):  # noqa: N818  # it says what happened
    """The header is none that a coder writes; the text says why."""


def main() -> None:
    """Answer the request."""
    _limit()
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    request = json.load(sys.stdin)
    sys.path.insert(0, request["clang"])
    try:
        answer = _read(request)
    except (_Refused, RecursionError) as error:
        what = str(error) if isinstance(error, _Refused) else "its types are nested too deeply"
        answer = {"wrong": [[what, "", 0, 0]]}
    answers.write(json.dumps(answer, separators=(",", ":")).encode())
    answers.flush()


def _limit() -> None:
    """Neither memory nor time without end. Where there are no limits, none is set."""
    try:
        import resource
    except ImportError:  # Windows
        return
    wanted = {resource.RLIMIT_AS: _MOST_MEMORY, resource.RLIMIT_CPU: _MOST_SECONDS, resource.RLIMIT_CORE: 0}
    for what, amount in wanted.items():
        _, most = resource.getrlimit(what)
        resource.setrlimit(what, (amount if most == resource.RLIM_INFINITY else min(amount, most), most))


def _read(request: dict[str, Any]) -> dict[str, Any]:
    from clang import cindex

    unit = f"every.{'cpp' if request['is_cpp'] else 'c'}"
    words = [*request["options"], *(word for name in request["headers"] for word in ("-include", name))]
    try:
        parsed = cindex.Index.create().parse(unit, args=words, unsaved_files=[(unit, "")])
    except cindex.TranslationUnitLoadError:
        sys.exit(1)  # libclang survives some of its crashes
    wrong = [each for each in parsed.diagnostics if each.severity >= cindex.Diagnostic.Error]
    if wrong:
        return {"wrong": [_problem(each) for each in wrong[:_MOST_TOLD]]}
    read = _Reader(cindex, request["folders"]).read(parsed.cursor)
    return {**read, "files": sorted({each.include.name for each in parsed.get_includes()} - {unit})}


def _problem(diagnostic: Any) -> list[Any]:
    place = diagnostic.location
    return [diagnostic.spelling, place.file.name if place.file else "", place.line, place.column]


class _Reader:
    def __init__(self, cindex: Any, folders: list[str]) -> None:
        self._kinds, self._type_kinds = cindex.CursorKind, cindex.TypeKind
        self._folders = {Path(folder).resolve() for folder in folders}
        self._texts: dict[str, bytes] = {}
        self._records: dict[str, Any] = {}
        self._ours: dict[str, str] = {}
        self._types: dict[tuple[Any, ...], int] = {}
        self._depth = self._count = 0

    def read(self, top: Cursor) -> dict[str, Any]:
        functions: dict[str, Any] = {}
        variables: dict[str, Any] = {}
        for cursor in self._top(top):
            file = self._file(cursor)
            if not file:
                continue
            if cursor.kind == self._kinds.FUNCTION_DECL:
                functions[cursor.spelling] = self._function(cursor, file)
            elif cursor.kind == self._kinds.VAR_DECL:
                variables[cursor.spelling] = self._declared(cursor, file)
            elif cursor.kind in (self._kinds.CLASS_DECL, self._kinds.STRUCT_DECL) and cursor.is_definition():
                self._type(cursor.type)
        types = list(self._types)
        return {"functions": functions, "variables": variables, "records": self._records, "types": types}

    def _top(self, cursor: Cursor) -> Iterator[Cursor]:
        through = (self._kinds.LINKAGE_SPEC, self._kinds.UNEXPOSED_DECL, self._kinds.NAMESPACE)
        for child in cursor.get_children():
            if child.kind in through:
                yield from self._top(child)
            else:
                yield child

    def _file(self, cursor: Cursor) -> str:
        """The file's name, if it is one of the model's."""
        if cursor.location.file is None:
            return ""
        name = cursor.location.file.name
        if name not in self._ours:
            path = Path(name)
            self._ours[name] = path.name if path.resolve().parent in self._folders else ""
        return self._ours[name]

    def _function(self, cursor: Cursor, file: str) -> list[Any]:
        void = cursor.result_type.kind == self._type_kinds.VOID
        arguments = [self._declared(each, file) for each in cursor.get_arguments()]
        return [_name(cursor), arguments, None if void else self._type(cursor.result_type), file]

    def _declared(self, cursor: Cursor, file: str) -> list[Any]:
        element = cursor.type
        while element.kind in (self._type_kinds.CONSTANTARRAY, self._type_kinds.INCOMPLETEARRAY):
            element = element.element_type
        is_constant = element.is_const_qualified()
        self._count += 1
        if self._count > _MOST_DECLARED:
            raise _Refused(f"it declares more than {_MOST_DECLARED:,} variables, members and arguments")
        return [_name(cursor), self._type(cursor.type), self._comment(cursor), is_constant, file]

    def _type(self, type_: Type) -> int:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise _Refused(f"a type has more than {_DEEPEST} others within each other")
        found = self._described(type_)
        self._depth -= 1
        return self._types.setdefault(found, len(self._types))

    def _described(self, type_: Type) -> tuple[Any, ...]:
        kinds = self._type_kinds
        plain = type_.get_canonical()
        if plain.kind == kinds.CONSTANTARRAY:
            inner = type_ if type_.kind == kinds.CONSTANTARRAY else plain
            return ("array", self._type(inner.element_type), plain.element_count)
        if plain.kind == kinds.INCOMPLETEARRAY:
            return ("array", self._type(plain.element_type), -1)
        if plain.kind in (kinds.POINTER, kinds.LVALUEREFERENCE):
            inner = type_.get_pointee() if type_.kind == plain.kind else plain.get_pointee()
            return ("pointer", self._type(inner), inner.get_canonical().is_const_qualified())
        if plain.kind == kinds.RECORD:
            return ("named", self._record(type_))
        return self._scalar(type_, plain)

    def _scalar(self, type_: Type, plain: Type) -> tuple[Any, ...]:
        kinds = self._type_kinds
        name = _plain_name(type_.spelling)
        if plain.kind in (kinds.DOUBLE, kinds.FLOAT):
            return ("scalar", name, "real", 0, 0, ())
        if plain.kind == kinds.ENUM:
            constants = plain.get_declaration().get_children()
            items = tuple(
                (_name(each), each.enum_value) for each in constants if each.kind == self._kinds.ENUM_CONSTANT_DECL
            )
            values = [value for _, value in items]
            return ("scalar", name, "enumeration", min(values, default=0), max(values, default=0), items)
        if plain.kind == kinds.BOOL or "boolean" in name:
            return ("scalar", name, "boolean", 0, 1, ())
        signed = (kinds.CHAR_S, kinds.SCHAR, kinds.SHORT, kinds.INT, kinds.LONG, kinds.LONGLONG)
        unsigned = (kinds.CHAR_U, kinds.UCHAR, kinds.USHORT, kinds.UINT, kinds.ULONG, kinds.ULONGLONG)
        bits = 8 * plain.get_size()
        if plain.kind in signed:
            return ("scalar", name, "integer", -(1 << bits - 1), (1 << bits - 1) - 1, ())
        if plain.kind in unsigned:
            return ("scalar", name, "integer", 0, (1 << bits) - 1, ())
        return ("other", name)

    def _record(self, type_: Type) -> str:
        declaration = type_.get_canonical().get_declaration()
        name = _plain_name(type_.spelling)
        if name not in self._records:
            size = type_.get_canonical().get_size()
            # Known before its fields are: a model points to itself.
            self._records[name] = [name, [], size, [], [], ""]
            file = self._file(declaration)
            fields = [self._declared(each, file) for each in type_.get_canonical().get_fields()]
            methods = [
                self._function(each, file)
                for each in declaration.get_children()
                if each.kind == self._kinds.CXX_METHOD and each.access_specifier.name == "PUBLIC"
            ]
            statics = [
                self._declared(each, file) for each in declaration.get_children() if each.kind == self._kinds.VAR_DECL
            ]
            self._records[name] = [name, fields, size, methods, statics, file]
        return name

    def _comment(self, cursor: Cursor) -> str:
        """The comment behind a declaration, also if it was wrapped to the next line."""
        end = cursor.extent.end
        if end.file is None:
            return ""
        if end.file.name not in self._texts:
            self._texts[end.file.name] = Path(end.file.name).read_bytes()
        found = _COMMENT.match(self._texts[end.file.name][end.offset : end.offset + _LONGEST_COMMENT])
        return b" ".join((found[1] or found[2] or b"").split()).decode("utf-8", "replace") if found else ""


def _name(cursor: Cursor) -> str:
    name = str(cursor.spelling)
    if len(name) > _LONGEST_NAME:
        raise _Refused(f"the name '{name[:40]}…' has {len(name):,} characters")
    return name


def _plain_name(spelling: str) -> str:
    """A type as C spells it where it is used, without qualifiers."""
    words = re.sub(r"\b(?:const|volatile)\b", "", spelling)
    return " ".join(words.split())


if __name__ == "__main__":
    main()
