"""From pydantic's findings to problems in the user's words."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError

from dse.errors import DseError, Problem
from dse.loading.yaml import Document, Path_


class Section(BaseModel):
    """A mapping in a file: unknown keys are refused, nothing is converted silently."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def _plain(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError("expected a number or text")  # noqa: TRY004  # pydantic turns only ValueError into a finding
    return value


Plain = Annotated[str | int | float, BeforeValidator(_plain)]
"""A quantity or expression as YAML reads it: a number, or text."""

Scalar = str | int | float | bool
"""A value of a parameter as YAML reads it."""

S = TypeVar("S", bound=Section)


def read_section(document: Document, shape: type[S]) -> S:
    """The document in the given *shape*. Raises DseError with every deviation, each at its key or value."""
    try:
        return shape.model_validate(document.data)
    except ValidationError as error:
        raise DseError(*_problems(document, shape, error)) from None


def closest(word: str, words: Iterable[str]) -> str:
    """A hint that names the word meant, or all that are possible."""
    known = sorted(words)
    close = difflib.get_close_matches(word, known, n=1)
    if close:
        return f"did you mean '{close[0]}'?"
    listed = ", ".join(known[:12])
    return f"possible: {listed}{', …' if len(known) > 12 else ''}" if known else ""


def _problems(document: Document, shape: type[Section], error: ValidationError) -> Iterable[Problem]:
    seen: set[tuple[object, str]] = set()
    for entry in error.errors(include_url=False, include_context=True):
        path = _path(document, entry["loc"])
        problem = _problem(document, shape, entry, path)
        # A union reports one finding per member; the first says enough.
        if (problem.where, problem.what) not in seen:
            seen.add((problem.where, problem.what))
            yield problem


def _path(document: Document, loc: tuple[str | int, ...]) -> Path_:
    """The part of pydantic's *loc* that stands in the document: union members' names are left out."""
    path: Path_ = ()
    for step in loc:
        if (*path, step) in document.places:
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
        known = _fields(shape, tuple(step for step in loc[:-1] if isinstance(step, str)))
        return Problem(f"unknown key '{loc[-1]}'", document.key(path), closest(str(loc[-1]), known))
    name = ".".join(map(str, path)) or "the file"
    return Problem(f"'{name}': {_words(entry)}", document.place(path), _hint(kind))


_WORDS = {
    "string_type": "expected text",
    "int_type": "expected a whole number",
    "float_type": "expected a number",
    "bool_type": "expected true or false",
    "list_type": "expected a list",
    "tuple_type": "expected a list",
    "dict_type": "expected a mapping",
    "model_type": "expected a mapping",
    "model_attributes_type": "expected a mapping",
}


def _words(entry: Any) -> str:
    words = _WORDS.get(entry["type"])
    if words is None:
        words = str(entry["msg"]).removeprefix("Value error, ")
        words = words[:1].lower() + words[1:]
    shown = repr(entry["input"])
    return f"{words}, found {shown if len(shown) <= 60 else shown[:57] + '…'}"


def _hint(kind: str) -> str:
    hints = {
        "string_type": "quote it if it is meant as text",
        "list_type": "write it as [a, b]",
        "tuple_type": "write it as [a, b]",
        "dict_type": "write it as {key: value}",
        "model_type": "write it as {key: value}",
        "bool_type": "YAML 1.2 knows only true and false",
    }
    return hints.get(kind, "")


def _fields(shape: type[Section], loc: tuple[str, ...]) -> set[str]:
    """Keys allowed in the section that *loc* leads to, found by following the field annotations."""
    shapes: list[type[Section]] = [shape]
    for step in loc:
        found: list[type[Section]] = []
        for current in shapes:
            # A step that is no field's name is a key of a mapping: the section below it was found already.
            field = current.model_fields.get(step)
            found += _sections(field.annotation) if field else [current]
        shapes = found or shapes
    names: set[str] = set()
    for current in shapes:
        names |= {info.alias or name for name, info in current.model_fields.items()}
    return names


def _sections(annotation: Any) -> list[type[Section]]:
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return [annotation]
    return [found for argument in getattr(annotation, "__args__", ()) for found in _sections(argument)]
