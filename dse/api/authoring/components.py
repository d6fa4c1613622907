"""Components and interfaces that are defined in Python."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from dse.api.authoring.defined import Arguments, Defined, Definitions, InWorkspace, called
from dse.api.authoring.python_source import module_of
from dse.domain import component as nouns
from dse.errors import fail
from dse.loading import is_file, read_document
from dse.scratch import make_folder, write_whole

if TYPE_CHECKING:
    from typing import Unpack

    from dse.formats import KeyPath

_FILE_KEYS = frozenset({"file", "files", "folder", "header"})
"""Keys of a source that name files."""


class InterfaceKeys(TypedDict, total=False):
    """The arguments of `Interface`: the keys of an interface in ``interfaces.yaml``, and its ``types``."""

    title: str
    inputs: Mapping[str, object]
    outputs: Mapping[str, object]
    optional: Sequence[str]
    stands_for: Mapping[str, object]
    types: Mapping[str, object]


class Interface(Defined[nouns.Interface]):
    """An interface that is defined in Python: the ports that alternatives share; *noun* is what it says."""

    def __init__(self, interface: str, *, workspace: InWorkspace | None = None, **keys: Unpack[InterfaceKeys]) -> None:
        """Define the interface called *interface*: *inputs* and *outputs* are mappings from ports to types.

        A type is a unit in SI (``"m/s"``, ``"1"`` for none), ``"bool"``, ``"int"``, ``"enum[a, b]"``, an array
        (``"m[3]"``), or a mapping for a group of ports. Raises DseError, which names the argument.
        """
        call = called("Interface", "interface", interface, ("interfaces", str(interface)))
        given = Arguments(call)
        data = {key: given.plain(value, (*call.path, key)) for key, value in keys.items()}
        file = {**({"types": data.pop("types")} if "types" in data else {}), "interfaces": {interface: data}}
        definitions = given.definitions(workspace)
        folder = definitions.files.root / "components" / "python_interfaces" / interface
        if interface in definitions.files.interfaces and not folder.exists():
            raise fail(f"the workspace has an interface '{interface}' already", given.at(()), "choose another name")
        with definitions.redefining(folder, call):
            make_folder(folder)
            definitions.write(folder / "interfaces.yaml", file, call)
            super().__init__(definitions.files.interfaces[interface], definitions, file)


class ComponentKeys(TypedDict, total=False):
    """The arguments of `Component`: the keys of ``component.yaml``."""

    title: str
    implements: str | Interface
    source: Mapping[str, object] | str | Path | type
    parameters: Mapping[str, object]
    properties: Mapping[str, object]
    map: Mapping[str, str]


class Component(Defined[nouns.Component]):
    """A component that is defined in Python; *noun* is what it says. In a design its name, or itself, is used."""

    def __init__(self, component: str, *, workspace: InWorkspace | None = None, **keys: Unpack[ComponentKeys]) -> None:
        """Define the component called *component*; the other arguments are the keys of its ``component.yaml``.

        *source* may also be an FMU (``"x.fmu"``), whose component is then what ``dse import fmu`` makes of it, or a
        class with the method ``step(self, inputs, h)``, whose source text becomes a file. In a mapping, ``file``,
        ``files``, ``folder`` and ``header`` name files by paths from the current folder; those outside the workspace
        are copied. ``files`` may have classes among them, or be a mapping from names to texts: ``{"x.c": "…", "x.h":
        "…"}``. Numbers without a unit are in the parameter's unit.

        Raises DseError, which names the argument: also for a file that is missing, and for a class without source text.
        """
        call = called("Component", "component", component)
        given = Arguments(call)
        source = keys.get("source")
        data = {key: given.plain(value, (key,)) for key, value in keys.items() if key != "source"}
        definitions = given.definitions(workspace)
        files = definitions.files
        folder = files.root / "components" / component
        known = files.component_files.get(component)
        if known is not None and known.parent != folder:
            raise fail(f"the workspace has a component '{component}' already", given.at(()), "choose another name")
        with definitions.redefining(folder, call):
            imported: Mapping[str, Any] = {}
            if isinstance(source, str | Path) and Path(source).suffix.lower() == ".fmu":
                path = _existing(Path(source), given, ("source",))
                if "implements" not in keys:
                    imported = _imported(path, component, definitions)
                source = {"kind": "fmu", "file": path}
            make_folder(folder)
            if source is not None and not imported:
                data["source"] = _SourceFiles(given, folder, component).written(source)
            data = {"component": component, **imported, **data}
            definitions.write(folder / "component.yaml", data, call)
            super().__init__(definitions.files.component(component), definitions, data)


def _imported(file: Path, name: str, definitions: Definitions) -> Mapping[str, Any]:
    """What ``dse import fmu`` writes for the FMU in *file*, which is copied. Raises DseError."""
    from dse.interchange import import_component

    root = definitions.files.root
    data: Mapping[str, Any] = read_document(import_component(file, root, name).path, root).data
    return data


def _existing(path: Path, given: Arguments, at: KeyPath) -> Path:
    if not is_file(path) and not path.is_dir():
        raise fail(f"no such file: {path}", given.at(at), f"paths are relative to the current folder, {Path.cwd()}")
    return path


class _SourceFiles:
    """Puts what a source names into the *folder* of the *component*."""

    def __init__(self, given: Arguments, folder: Path, component: str) -> None:
        self._given = given
        self._folder = folder
        self._component = component

    def written(self, source: Mapping[str, object] | str | Path | type) -> Mapping[str, Any]:
        """The ``source`` of the component's file."""
        if isinstance(source, type):
            found: dict[str, Any] = {"kind": "python"}
            found["files"] = [self._files(source, ("source",), found)]
            return found
        if not isinstance(source, Mapping):
            what = f"'{source}' is neither an FMU, a class nor a mapping"
            raise fail(what, self._given.at(("source",)), "source={'kind': 'c', 'files': ['x.c', 'x.h']}")
        found = {}
        for key, value in source.items():
            if key in _FILE_KEYS:
                found[key] = self._files(value, ("source", key), found)
            else:
                found[key] = self._given.plain(value, ("source", key))
        return found

    def _files(self, value: object, at: KeyPath, found: dict[str, Any]) -> Any:
        """The names that files have in the folder; of a class, its name is *found*, too."""
        if isinstance(value, Mapping):
            return [self._text(str(name), text, (*at, str(name))) for name, text in value.items()]
        if isinstance(value, list | tuple):
            return [self._files(each, (*at, number), found) for number, each in enumerate(value)]
        if isinstance(value, type):
            found.setdefault("class_name", value.__name__)
            return self._text(f"{self._component}.py", module_of(value, self._given.at(at)), at)
        path = Path(self._given.plain(value, at))
        if at[-1] == "header" and is_file(self._folder / path):  # of the files
            return str(path)
        _existing(path, self._given, at)
        if path.resolve().is_relative_to(self._folder.parents[1]):  # of the workspace already
            return Path(os.path.relpath(path.resolve(), self._folder)).as_posix()
        if path.suffix in (".yaml", ".yml"):  # below components/ it would be read as components
            raise fail(f"'{path}' is outside the workspace", self._given.at(at), "copy it into the workspace")
        if path.is_dir():
            shutil.copytree(path, self._folder / path.name)
            return path.name
        header = path.with_suffix(".h")
        if path.suffix == ".c" and is_file(header):
            self._put(header.name, header.read_bytes(), at)
        return self._put(path.name, path.read_bytes(), at)

    def _text(self, name: str, text: object, at: KeyPath) -> str:
        if not isinstance(text, str) or Path(name).name != name:
            raise fail(f"'{name}' must be the name of a file, with its text", self._given.at(at), "{'x.c': '…'}")
        return self._put(name, text.encode(), at)

    def _put(self, name: str, content: bytes, at: KeyPath) -> str:
        file = self._folder / name
        if is_file(file) and file.read_bytes() != content:
            raise fail(f"two files are called '{name}'", self._given.at(at), "rename one")
        write_whole(file, content)
        return name
