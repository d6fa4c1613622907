"""Pages that are generated from the program: commands, keys of files, Python and the component library."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import groupby
from pathlib import Path
from typing import Any

import typer

import dse
from dse.cli.app import app
from dse.cli.commands import COMMANDS, register
from dse.domain.component import Component
from dse.domain.expression import ROLLUPS
from dse.loading import FILE_KINDS, Workspace, file_schema
from dse.metrics import FUNCTIONS, Argument, Function, Wants
from dse.pictures import draw_component, pictured
from dse.units import describe

ROOT = Path(__file__).parents[2]


def write(pages: Path) -> None:
    """Write all of them into *pages*/reference."""
    folder = pages / "reference"
    _write(folder / "python.md", python())
    _write(folder / "commands.md", commands())
    _write(folder / "functions.md", functions())
    for kind in FILE_KINDS:
        _write(folder / "files" / f"{kind}.md", keys_of(file_schema(kind)))
    _write(folder / "files" / "index.md", files())
    library(folder / "components")


def python() -> str:
    """What `dse.__all__` names, with everything public in it."""
    text = """# Python: all public names

What each name does, its arguments, units and errors. [Use dse from Python](../docs/python.md) shows them in use.
Numbers are in SI units unless a text states other units.

```{eval-rst}
.. py:module:: dse
```
"""
    for name in sorted(dir(dse), key=lambda name: (name[0].isupper(), name)):  # functions first
        shape = getattr(dse, name)
        kind = "function" if not isinstance(shape, type) else "exception" if issubclass(shape, Exception) else "class"
        members = "" if kind == "function" else "   :members:\n   :inherited-members: Exception, KeyboardInterrupt\n"
        text += f"\n## {name}\n\n```{{eval-rst}}\n.. auto{kind}:: dse.{name}\n{members}```\n"
    return text


def commands() -> str:
    """Every command with its arguments and options, as its ``--help`` has them."""
    register()
    text = "# Commands\n\n`dse COMMAND --help` prints these texts. A command ends with an "
    text += "[exit code](../docs/formats.md#exit-codes).\n"
    # In the order of the help, whichever was imported first here.
    places = {each.partition(".")[0].replace("_", "-").rstrip("-"): place for place, each in enumerate(COMMANDS)}
    listed = sorted(_below(typer.main.get_command(app)), key=lambda each: places.get(each[0], len(places)))
    return text + "".join(_command(f"dse {name}", command) for name, command in listed)


def _below(group: Any) -> Iterable[tuple[str, Any]]:
    context = group.context_class(group)
    return [(name, group.get_command(context, name)) for name in group.list_commands(context)]


def _command(name: str, command: Any) -> str:
    text = f"\n## {name}\n\n{_escaped(_unwrapped(command.help))}\n"
    if below := getattr(command, "commands", None):
        return text + "".join(_command(f"{name} {word}", each) for word, each in below.items())
    context = command.context_class(command, info_name=name)
    usage = " ".join(command.collect_usage_pieces(context))
    text += f"\n```text\n{name} {usage}\n```\n"
    arguments: list[tuple[str, str]] = []
    options: list[tuple[str, str]] = []
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context)
        if record is not None:
            (options if parameter.param_type_name == "option" else arguments).append((f"`{record[0]}`", record[1]))
    return text + _table(("Argument", "Meaning"), arguments) + _table(("Option", "Meaning"), options)


def functions() -> str:
    """What metrics and constraints can call: arguments and dimension of each function."""
    text = "# Functions of metrics and constraints\n\n"
    text += "The arguments of each function, what they must be, and the dimension of the result.\n\n## Metrics\n\n"
    text += "[Metrics](../docs/formats.md#metrics) has the definitions.\n"
    rows = [
        (f"`{name}`", "; ".join(map(_argument, each.arguments)), _result(each))
        for name, each in sorted(FUNCTIONS.items())
    ]
    text += _table(("Function", "Arguments", "Result"), rows)
    text += "\n## Constraints\n\n[Static constraints](../docs/formats.md#static-constraints) has the conditions, and "
    text += "[Expressions](../docs/formats.md#expressions) has the operators. "
    return text + f"Roll-ups over all parts that state a property: {', '.join(f'`{name}`' for name in ROLLUPS)}.\n"


def _argument(argument: Argument) -> str:
    unit = f" in {argument.unit}" if argument.unit else "" if argument.unit == "" else " in the unit of the first"
    if argument.wants is Wants.CONDITION or argument.any_unit:
        unit = ""
    default = f" (default {argument.default:g})" if argument.default is not None else ""
    return f"`{argument.name}`: {argument.wants}{unit}{', 0 … 1' if argument.share else ''}{default}"


def _result(function: Function) -> str:
    dimension = describe(function.result((("x", Fraction(1)),))).replace("x", "the dimension of x").replace("*", " × ")
    return f"a waveform: {dimension}" if function.varies else dimension


def files() -> str:
    """The kinds of files, each with a link to its keys."""
    rows = [(f"[{kind}]({kind}.md)", file_schema(kind)["title"]) for kind in FILE_KINDS]
    text = "# Keys of all files\n\nThe schemas of `dse schema` as tables: each key, its values and its default. "
    text += "[The files dse reads and writes](../../docs/formats.md) explains them.\n"
    return text + _table(("File", "Content"), rows) + _contents(FILE_KINDS)


def keys_of(schema: Mapping[str, Any]) -> str:
    """The keys of a kind of file, section by section."""
    names = ", ".join(f"`{name}`" for name in schema["properties"])
    text = f"# {schema['title']}\n\nKeys of the file: {names}.\n" + _keys(schema, schema["anyOf"][0]["required"])
    for name, section in sorted(schema.get("$defs", {}).items()):
        text += f"\n## {_label(name)}\n\n{section.get('description', '')}\n"
        text += _keys(section, section.get("required", ())) or f"\n{_values(section)}\n"
    return text


def _keys(section: Mapping[str, Any], required: Sequence[str]) -> str:
    rows = [
        (
            f"`{key}`" + (" (required)" if key in required else ""),
            _values(value),
            f"`{value['default']}`" if value.get("default") not in (None, "", {}, []) else "",
            value.get("description", ""),
        )
        for key, value in section.get("properties", {}).items()
    ]
    return _table(("Key", "Value", "Default", "Meaning"), rows)


def _values(value: Mapping[str, Any]) -> str:
    """What a value may be, in words."""
    if "$ref" in value:
        name = value["$ref"].rpartition("/")[2]
        return f"[{_label(name)}](#{_label(name).replace(' ', '-').lower()})"
    if "const" in value:
        return f"`{value['const']}`"
    if "enum" in value:
        return ", ".join(f"`{each}`" for each in value["enum"])
    for key in ("anyOf", "oneOf"):
        if key in value:
            return " or ".join(dict.fromkeys(_values(each) for each in value[key]))
    kind = value.get("type", "any value")
    if isinstance(kind, list):
        return " or ".join(kind)
    if kind == "array":
        return f"list of {_values(value['items'])}" if value.get("items") else "list"
    if kind == "object":
        properties, others = value.get("properties"), value.get("additionalProperties")
        if properties:
            return "mapping with " + ", ".join(f"`{key}`: {_values(each)}" for key, each in properties.items())
        return f"mapping of names to {_values(others)}" if others else "mapping"
    return "number" if kind == "integer" and "number" in str(value) else str(kind)


def _label(name: str) -> str:
    words = name.removesuffix("Section").replace("_", " ")
    return "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in words).strip()


def library(folder: Path) -> None:
    """A page for each folder of the component library, with pictures, properties, parameters and ports."""
    space = Workspace.around(ROOT)
    found = [space.component(name) for name in space.component_files]
    families = {
        name: Path(path).relative_to(ROOT / "components").parts[0] for name, path in space.component_files.items()
    }
    found.sort(key=lambda component: (families[component.name], component.name))
    rows, names = [], []
    for family, members in groupby(found, key=lambda component: families[component.name]):
        group = list(members)
        for component in group:
            picture = folder / "pictures" / f"{component.name}.svg"
            _write(picture, draw_component(component, pictured(component)))
        _write(
            folder / f"{family}.md",
            f"# {family}\n\n{', '.join(each.name for each in group)}.\n" + "".join(map(_component, group)),
        )
        links = ", ".join(f"[{each.name}]({family}.md#{each.name.replace('_', '-')})" for each in group)
        rows.append((f"[{family}]({family}.md)", links))
        names.append(family)
    text = "# Component library\n\n`dse init` copies these components into a workspace. "
    text += "[Component](../files/component.md) has the keys of their files.\n"
    _write(folder / "index.md", text + _table(("Family", "Components"), rows) + _contents(names))


def _component(component: Component) -> str:
    from dse.cli.commands.components import data  # not before all commands are registered, in their order

    facts = data(component)
    properties = "".join(f", {name} {quantity}" for name, quantity in facts["properties"].items())
    parameters: dict[str, tuple[str, ...]] = {}
    for name, each in facts["parameters"].items():  # of an array the first item
        bounds = "" if each["min"] is each["max"] is None else f"{_number(each['min'])} … {_number(each['max'])}"
        row = (_number(each["start"]), bounds, each["unit"], each["title"])
        parameters.setdefault(re.sub(r"\[\d+\]", "[…]", name), row)
    ports: dict[str, list[Mapping[str, str]]] = {}
    for name, each in facts["ports"].items():
        ports.setdefault(re.split(r"[.\[]", name)[0], []).append(each)
    return (
        f"\n## {component.name}\n\n{_escaped(component.title)}\n\n"
        f"Implements `{facts['implements']}`; source: {facts['source']}{properties}.\n\n"
        f"![ports of {component.name}](pictures/{component.name}.svg)\n"
        + _table(
            ("Parameter", "Start", "Range", "Unit", "Meaning"),
            [(f"`{name}`", *row) for name, row in parameters.items()],
        )
        + _table(
            ("Port", "Direction", "Unit or type"),
            [
                (f"`{name}`", each[0]["causality"], each[0]["type"] if len(each) == 1 else f"{len(each)} values")
                for name, each in ports.items()
            ],
        )
    )


def _number(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else "∞" if value is None else str(value)


def _table(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A table in Markdown, without columns that are empty; nothing without rows."""
    kept = [at for at in range(len(heads)) if any(row[at] not in (None, "") for row in rows)]
    lines = [[heads[at] for at in kept], ["---"] * len(kept), *([_cell(row[at]) for at in kept] for row in rows)]
    return "\n" + "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n" if rows else ""


def _cell(value: object) -> str:
    return "" if value is None else _escaped(" ".join(str(value).split())).replace("|", "\\|")


def _escaped(text: str) -> str:
    """*text* without what would be markup by chance; code and links stay."""
    parts = text.split("`")  # every other one is code
    parts[::2] = [part.replace("<", "&lt;").replace("*", "\\*") for part in parts[::2]]
    return "`".join(parts)


def _unwrapped(text: str | None) -> str:
    return "\n\n".join(" ".join(part.split()) for part in (text or "").split("\n\n"))


def _contents(names: Iterable[str]) -> str:
    return "\n```{toctree}\n:hidden:\n\n" + "\n".join(names) + "\n```\n"


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
