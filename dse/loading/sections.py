"""From pydantic's findings to problems in the user's words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError

from dse.errors import DseError, Problem, closest
from dse.formats import Entry, KeyPath


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

S = TypeVar("S", bound=Section)


def read_section(entry: Entry, shape: type[S]) -> S:
    """What stands at *entry* in the given *shape*. Raises DseError with every deviation, each at its key or value."""
    try:
        return shape.model_validate(entry.data)
    except ValidationError as error:
        raise DseError(*_problems(entry, shape, error)) from None


def _problems(top: Entry, shape: type[Section], error: ValidationError) -> Iterable[Problem]:
    findings = [(_entry(top, e["loc"]), e) for e in error.errors(include_url=False, include_context=True)]
    later = {entry.path[:-1] for entry, finding in findings if _is_later(shape, finding)}
    merged: dict[KeyPath, list[tuple[Entry, Any]]] = {}
    for entry, finding in findings:
        size = len(entry.path)
        if finding["type"] in _EXPECTED:
            # A union reports one finding per member. Those whose shape is another say nothing if one fits.
            if not any(other["type"] not in _EXPECTED and at.path[:size] == entry.path for at, other in findings):
                merged.setdefault(entry.path, []).append((entry, finding))
        elif finding["type"] != "missing" or entry.path not in later:
            yield _problem(shape, finding, entry)
    for path, found in merged.items():
        kinds = [finding["type"] for _, finding in found]
        entry, finding = found[-1]
        what = f"'{_name(entry)}': expected {_either(kinds)}, found {_kind(finding['input'])}"
        usual = _HINTS.get(kinds[0], "") if len(kinds) == 1 else ""
        yield Problem(what, entry.where, _own_hint(shape, path[len(top.path) :]) or usual)


def _entry(top: Entry, loc: tuple[str | int, ...]) -> Entry:
    """What pydantic's *loc* below *top* means in the document: union members' names are left out."""
    for step in loc:
        if top[step].is_there:
            top = top[step]
    return top


def _problem(shape: type[Section], finding: Any, entry: Entry) -> Problem:
    kind, loc = finding["type"], finding["loc"]
    if kind == "missing":
        inside = f" in '{_name(entry)}'" if entry.path else ""
        hint = f"add {loc[-1]}=…" if entry.document.call and len(loc) == 1 else f"add '{loc[-1]}: …'"
        return Problem(f"'{loc[-1]}' is missing{inside}", entry.key, hint)
    if kind == "extra_forbidden":
        if _is_later(shape, finding):
            hint = "'dse docs formats' has the list, under 'Not supported in this version'"
            return Problem(f"'{loc[-1]}' is not supported in this version", entry.key, hint)
        known = {name for section in _sections_at(shape, loc[:-1]) for name in section.model_fields}
        key = str(loc[-1])
        if key.count(")") != key.count("("):  # the end of an expression: {where: max(a, b) > 1}
            return Problem(f"unexpected '{key}'", entry.key, _QUOTE)
        return Problem(f"unknown key '{key}'", entry.key, closest(key, known))
    what = f"'{_name(entry)}': {_words(finding)}, found {_shown(finding['input'])}"
    return Problem(what, entry.where, _own_hint(shape, loc))


_QUOTE = "in braces a comma ends a value: quote an expression that has commas, as {where: 'max(a, b) > 1'}"


def _is_later(shape: type[Section], finding: Any) -> bool:
    """Whether the finding is a key that a later version will know."""
    if finding["type"] != "extra_forbidden":
        return False
    return any(finding["loc"][-1] in section.later for section in _sections_at(shape, finding["loc"][:-1]))


def _own_hint(shape: type[Section], path: KeyPath) -> str:
    """What the section that *path* leads to says of its last key."""
    sections = _sections_at(shape, path[:-1]) if path else []
    return next((section.hints[str(path[-1])] for section in sections if str(path[-1]) in section.hints), "")


def _name(entry: Entry) -> str:
    return ".".join(map(str, entry.path)) or "the file"


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
    "bool_type": "YAML 1.2 has only true and false",
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


def _sections(annotation: Any) -> list[type[Section]]:
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return [annotation]
    return [found for argument in getattr(annotation, "__args__", ()) for found in _sections(argument)]
