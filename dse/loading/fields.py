"""From pydantic's findings to problems in the user's words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError

from dse.errors import DseError, Problem, closest
from dse.formats.yaml import Document, Path_


class Section(BaseModel):
    """A mapping in a file: unknown keys are refused, nothing is converted silently.

    Keys in *later* are refused, too, but as what this version does not support. *hints* say how a key is written.
    """

    later: ClassVar[frozenset[str]] = frozenset()
    hints: ClassVar[Mapping[str, str]] = {}

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, defer_build=True)


def _plain(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError("expected a number or text")  # noqa: TRY004  # pydantic turns only ValueError into a finding
    return value


Plain = Annotated[str | int | float, BeforeValidator(_plain)]
"""A quantity or expression as YAML reads it: a number, or text."""

Scalar = str | int | float | bool
"""A value of a parameter as YAML reads it."""

S = TypeVar("S", bound=Section)


def read_section(document: Document, shape: type[S], at: Path_ = ()) -> S:
    """What stands at *at* in the document, by default all of it, in the given *shape*.

    Raises DseError with every deviation, each at its key or value.
    """
    data: Any = document.data
    for step in at:
        data = data[step]
    try:
        return shape.model_validate(data)
    except ValidationError as error:
        raise DseError(*_problems(document, shape, error, at)) from None


def _problems(document: Document, shape: type[Section], error: ValidationError, at: Path_) -> Iterable[Problem]:
    entries = [(_path(document, e["loc"], at), e) for e in error.errors(include_url=False, include_context=True)]
    later = {path[:-1] for path, entry in entries if _is_later(shape, entry)}
    merged: dict[Path_, list[str]] = {}
    for path, entry in entries:
        kind = entry["type"]
        if kind in _EXPECTED:
            # A union reports one finding per member. Those whose shape is another say nothing if one fits.
            if not any(other["type"] not in _EXPECTED and at[: len(path)] == path for at, other in entries):
                merged.setdefault(path, []).append(kind)
        elif kind != "missing" or path not in later:
            yield _problem(document, shape, entry, path)
    inputs = {path: entry["input"] for path, entry in entries if entry["type"] in _EXPECTED}
    for path, kinds in merged.items():
        what = f"'{_name(path)}': expected {_either(kinds)}, found {_kind(inputs[path])}"
        usual = _HINTS.get(kinds[0], "") if len(kinds) == 1 else ""
        yield Problem(what, document.place(path), _own_hint(shape, path[len(at) :]) or usual)


def _path(document: Document, loc: tuple[str | int, ...], at: Path_) -> Path_:
    """The part of pydantic's *loc* below *at* that stands in the document: union members' names are left out."""
    path = at
    for step in loc:
        if document.has((*path, step)):
            path = (*path, step)
    return path


def _problem(document: Document, shape: type[Section], entry: Any, path: Path_) -> Problem:
    kind, loc = entry["type"], entry["loc"]
    if kind == "missing":
        inside = ".".join(map(str, path))
        return Problem(
            f"'{loc[-1]}' is missing" + (f" in '{inside}'" if inside else ""), document.key(path), f"add '{loc[-1]}: …'"
        )
    if kind == "extra_forbidden":
        if _is_later(shape, entry):
            hint = "'dse docs formats' has the list, under 'Not supported in this version'"
            return Problem(f"'{loc[-1]}' is not supported in this version", document.key(path), hint)
        known = _fields(_sections_at(shape, loc[:-1]))
        return Problem(f"unknown key '{loc[-1]}'", document.key(path), closest(str(loc[-1]), known))
    return Problem(f"'{_name(path)}': {_words(entry)}, found {_shown(entry['input'])}", document.place(path))


def _is_later(shape: type[Section], entry: Any) -> bool:
    """Whether the finding is a key that a later version will know."""
    if entry["type"] != "extra_forbidden":
        return False
    return any(entry["loc"][-1] in section.later for section in _sections_at(shape, entry["loc"][:-1]))


def _own_hint(shape: type[Section], path: Path_) -> str:
    """What the section that *path* leads to says of its last key."""
    sections = _sections_at(shape, path[:-1]) if path else []
    return next((section.hints[str(path[-1])] for section in sections if str(path[-1]) in section.hints), "")


def _name(path: Path_) -> str:
    return ".".join(map(str, path)) or "the file"


_EXPECTED = {
    "string_type": "text",
    "int_type": "a whole number",
    "float_type": "a number",
    "bool_type": "true or false",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
}
_HINTS = {
    "string_type": "quote it if it is meant as text",
    "list_type": "write it as [a, b]",
    "tuple_type": "write it as [a, b]",
    "dict_type": "write it as {key: value}",
    "model_type": "write it as {key: value}",
    "bool_type": "YAML 1.2 knows only true and false",
}


def _either(kinds: list[str]) -> str:
    words = list(dict.fromkeys(_EXPECTED[kind] for kind in kinds))
    if "a number" in words and "a whole number" in words:
        words.remove("a whole number")
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _words(entry: Any) -> str:
    if entry["type"] in ("too_short", "too_long"):
        bound = entry["ctx"]["min_length" if entry["type"] == "too_short" else "max_length"]
        return f"expected {bound} entries"
    words = str(entry["msg"]).removeprefix("Value error, ")
    return words[:1].lower() + words[1:]


def _shown(value: object) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    shown = repr(value)
    return shown if len(shown) <= 60 else shown[:57] + "…"


def _kind(value: object) -> str:
    """What a value is, where another kind is expected."""
    if isinstance(value, dict):
        return "a mapping"
    return "a list" if isinstance(value, list | tuple) else _shown(value)


def _sections_at(shape: type[Section], loc: tuple[str | int, ...]) -> list[type[Section]]:
    """The sections that *loc* leads to, found by following the field annotations."""
    shapes: list[type[Section]] = [shape]
    for step in loc:
        found: list[type[Section]] = []
        for current in shapes:
            # A step that is no field's name is a key of a mapping: the section below it was found already.
            field = current.model_fields.get(str(step))
            found += _sections(field.annotation) if field else [current]
        shapes = found or shapes
    return shapes


def _fields(shapes: Iterable[type[Section]]) -> set[str]:
    """Keys allowed in sections of these *shapes*."""
    return {info.alias or name for current in shapes for name, info in current.model_fields.items()}


def _sections(annotation: Any) -> list[type[Section]]:
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return [annotation]
    return [found for argument in getattr(annotation, "__args__", ()) for found in _sections(argument)]
