"""JSON Schemas of the files a user writes, for editors: what may stand where, made of the sections that read them.

They tell what the keys are and what kind of value each has. Names, units and expressions are `dse check`'s business.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from dse.domain.study import CheckStep, Keep
from dse.loading.bench.bench import BenchFile
from dse.loading.bench.procedure import ProcedureFile
from dse.loading.bench.rating import RatingFile
from dse.loading.bench.study import StudyFile
from dse.loading.component.component import CollectionFile, ComponentFile
from dse.loading.component.interfaces import InterfacesFile
from dse.loading.component.kind import KINDS
from dse.loading.design.allocation import AllocateSection
from dse.loading.design.connection_choice import ConnectSection
from dse.loading.design.design import DesignFile
from dse.loading.design.forms import FORMS, ConstraintSection
from dse.loading.extensions import EXECUTORS, SAMPLERS, Extension
from dse.loading.road.road import RoadFile
from dse.loading.road.shapes import SHAPES
from dse.loading.sections import Section
from dse.registry import Registry

Schema = dict[str, Any]

_DRAFT = "http://json-schema.org/draft-07/schema#"
_NUMBERED = r"^[0-9]{1,8}$"


def file_schema(kind: str) -> Schema:
    """The schema of a file of the *kind*, one of `FILE_KINDS`, as JSON; with all kinds of components, samplers and
    executors that are installed. Raises DseError if one of these cannot be loaded."""
    shape, title, finish = _FILES[kind]
    schema = _of(shape)
    finish(schema)
    required = schema.pop("required", [])
    schema["properties"]["include"] = {
        "description": "Files joined into this one, relative to it.",
        "type": "array",
        "items": {"type": "string"},
    }
    # What an included file says need not be said again, nor any part of a section.
    whole: Schema = {"required": required}
    for key, value in schema["properties"].items():
        section = schema.get("$defs", {}).get(value.get("$ref", "").rpartition("/")[2], {})
        if needed := section.pop("required", []):
            whole.setdefault("properties", {})[key] = {"required": needed}
    schema["anyOf"] = [whole, {"required": ["include"]}]
    return {"$schema": _DRAFT, "title": title, **{key: schema[key] for key in sorted(schema)}}


def _component(schema: Schema) -> None:
    kinds = list(KINDS.names())
    source: Schema = {
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": {"enum": kinds}},
        "allOf": [],
    }
    for word in kinds:
        shape = _into(schema, KINDS.get(word).section, f"source_{word}")
        source["allOf"].append({"if": {"properties": {"kind": {"const": word}}}, "then": shape})
    schema["properties"]["source"] = source


def _interfaces(schema: Schema) -> None:
    schema["$defs"]["port"] = {
        "description": "A unit, bool, int, enum[a, b], string or a type; or a group of ports.",
        "anyOf": [
            {"type": ["string", "number"]},
            {"type": "object", "additionalProperties": {"$ref": "#/$defs/port"}},
        ],
    }
    for side in ("inputs", "outputs"):
        schema["$defs"]["InterfaceSection"]["properties"][side]["additionalProperties"] = {"$ref": "#/$defs/port"}
    schema["properties"]["types"]["additionalProperties"] = {"$ref": "#/$defs/port"}


def _design(schema: Schema) -> None:
    constraint = _into(schema, ConstraintSection, "ConstraintSection")
    defined = schema["$defs"]["ConstraintSection"]
    defined["oneOf"] = [{"required": [form]} for form in FORMS]
    for form in ("at_least", "at_most", "exactly"):
        defined["properties"][form] |= {"propertyNames": {"pattern": _NUMBERED}, "maxProperties": 1}
        defined["properties"][form].pop("additionalProperties")
    compound: Schema = {
        "type": "object",
        "required": ["compound"],
        "additionalProperties": False,
        "properties": {
            "compound": {"type": "object", "additionalProperties": {"$ref": "#/$defs/node"}},
            "connections": {"type": "array", "items": {"type": "string", "pattern": "->"}},
            "implements": {"type": "string"},
            "constraints": {"type": "object", "additionalProperties": constraint},
            "repeated": {"type": "boolean"},
        },
    }
    number = {"anyOf": [{"type": "integer"}, {"type": "string", "pattern": r"^[0-9]+(\.\.[0-9]+)?$"}]}
    repetition = {"times": number, "unordered": {"type": "boolean"}, "all_different": {"type": "boolean"}}
    repeated = {
        "of": {"$ref": "#/$defs/node"},
        **{key: value for key, value in compound["properties"].items() if key != "repeated"},
    }
    option = {"type": "object", "additionalProperties": {"$ref": "#/$defs/compound"}, "maxProperties": 1}
    schema["$defs"] |= {
        "compound": compound,
        "alternatives": _only("alternatives", {"type": "array", "items": {"anyOf": [{"type": "string"}, option]}}),
        "optional": _only("optional", {"$ref": "#/$defs/node"}),
        "times": {
            "type": "object",
            "required": ["times"],
            "additionalProperties": False,
            "properties": {
                **repetition,
                **repeated,
                "alternatives": {"$ref": "#/$defs/alternatives/properties/alternatives"},
            },
        },
        "node": {
            "description": "A component's name, {alternatives: […]}, {optional: …}, {compound: …}, {times: …}, "
            "{connect: …} or {allocate: …}.",
            "anyOf": [
                {"type": "string"},
                *({"$ref": f"#/$defs/{name}"} for name in ("alternatives", "optional", "compound", "times")),
                _into(schema, ConnectSection, "ConnectSection"),
                _into(schema, AllocateSection, "AllocateSection"),
            ],
        },
    }
    schema["properties"]["root"] = {"$ref": "#/$defs/compound"}


def _only(key: str, value: Schema) -> Schema:
    return {"type": "object", "required": [key], "additionalProperties": False, "properties": {key: value}}


def _study(schema: Schema) -> None:
    properties = schema["properties"]
    properties["sampler"] = _extension(schema, SAMPLERS, properties["sampler"])
    properties["executor"] = _extension(schema, EXECUTORS, properties["executor"])
    for key, words in (("keep_waveforms", Keep), ("check_step", CheckStep)):
        properties[key] = {"enum": [str(word) for word in words], "default": properties[key]["default"]}


def _road(schema: Schema) -> None:
    schema["$defs"]["SegmentSection"]["oneOf"] = [{"required": [shape]} for shape in SHAPES]


def _extension(schema: Schema, registry: Registry[type[Any]], field: Schema) -> Schema:
    """``NAME`` where that needs no options, or ``{NAME: {option: …}}``."""
    options: dict[str, Schema] = {}
    alone = []
    for name in registry.names():
        shape: type[Extension] = registry.get(name)
        hidden = [word for word, each in shape.model_fields.items() if each.exclude]
        options[name] = _into(schema, shape, f"{registry.word}_{name}".replace(" ", "_"), hidden)
        if shape.short:
            options[name] = {"anyOf": [options[name], {"type": "string"}]}
        if not any(each.is_required() for each in shape.model_fields.values()):
            alone.append(name)
    whole = {
        "type": "object",
        "properties": options,
        "additionalProperties": False,
        "minProperties": 1,
        "maxProperties": 1,
    }
    return {"anyOf": [{"enum": alone}, whole], "default": field.get("default")}


_FILES: Mapping[str, tuple[type[Section], str, Callable[[Schema], None]]] = {
    "component": (ComponentFile, "A component (component.yaml)", _component),
    "interfaces": (InterfacesFile, "Interfaces (interfaces.yaml)", _interfaces),
    "components": (CollectionFile, "Components without a source (components/*.yaml)", lambda _: None),
    "design": (DesignFile, "A design space (designs/*.yaml)", _design),
    "bench": (BenchFile, "A test bench (testbenches/*.yaml)", lambda _: None),
    "road": (RoadFile, "A road (roads/*.yaml)", _road),
    "study": (StudyFile, "A study (testbenches/*.pet.yaml)", _study),
    "rating": (RatingFile, "A rating (testbenches/*.rating.yaml)", lambda _: None),
    "procedure": (ProcedureFile, "A test procedure (testbenches/*.procedure.yaml)", lambda _: None),
}

FILE_KINDS = tuple(_FILES)
"""The kinds of files there is a schema of."""


def _of(shape: type[Section]) -> Schema:
    """What *shape* allows, without what only pydantic wants to know."""
    schema: Schema = _plain(shape.model_json_schema())
    schema.setdefault("$defs", {})
    return schema


def _into(schema: Schema, shape: type[Section], name: str, hidden: list[str] | None = None) -> Schema:
    """*shape* as one of the definitions of *schema*, called *name*; without the keys *hidden*. Its reference."""
    found = _of(shape)
    schema["$defs"] |= found.pop("$defs")
    for key in hidden or ():
        found["properties"].pop(key)
    schema["$defs"][name] = found
    return {"$ref": f"#/$defs/{name}"}


def _plain(value: Any) -> Any:
    """Without titles made of the names of classes and keys, and without null, which nobody writes."""
    if isinstance(value, list):
        return [_plain(entry) for entry in value]
    if not isinstance(value, dict):
        return value
    found: Schema = {
        key: {name: _plain(each) for name, each in entry.items()} if key in ("properties", "$defs") else _plain(entry)
        for key, entry in value.items()
        if not (key == "title" and isinstance(entry, str)) and not (key == "default" and entry is None)
    }
    if {"type": "null"} in found.get("anyOf", ()):
        others = [entry for entry in found.pop("anyOf") if entry != {"type": "null"}]
        found |= others[0] if len(others) == 1 else {"anyOf": others}
    if "description" in found:
        found["description"] = " ".join(found["description"].replace("``", "'").split())
    return found
