"""The front-end's answers, kept: the same files with the same structural values are not translated twice."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from dse.cache import content_key, read_entry, try_to_put
from dse.modelica.frontend.compile import read_answer
from dse.modelica.frontend.literal import Value, literal
from dse.modelica.frontend.process import VERSION
from dse.modelica.frontend.result import FrontEndResult
from dse.modelica.frontend.sources import ModelSources, library_contents
from dse.modelica.frontend.structural.probe import compile_probed

_ROOT = "$library/"


@dataclass(frozen=True, slots=True)
class AnswerCache:
    """Where answers are kept, and the name of the program that asks: another might ask for something else."""

    folder: Path
    program: str

    def compiled(self, sources: ModelSources, structural: Mapping[str, Value]) -> FrontEndResult:
        """As `compile_probed`. Only what was found right is kept. Raises DseError."""
        kept = self.folder / f"{self._key(sources, structural)}.json"
        content = read_entry(kept)
        if content is not None:
            return _recalled(sources, content)
        result = compile_probed(sources, structural)
        try_to_put(kept, _written(sources, result))
        return result

    def _key(self, sources: ModelSources, structural: Mapping[str, Value]) -> str:
        given = {name: literal(value) for name, value in sorted(structural.items())}
        asked = json.dumps([self.program, VERSION, sources.model, list(given.items()), len(sources.roots)])
        return content_key(
            [
                ("asked", asked.encode()),
                *((f"file/{name}", content) for name, content in sorted(sources.contents.items())),
                *((f"library/{name}", content) for name, content in library_contents(sources)),
            ]
        )


def _written(sources: ModelSources, result: FrontEndResult) -> bytes:
    """*result* without the places of the libraries, which may be others next time."""
    files = [[number, _without_root(sources, path), text] for number, path, text in result.dae["source_map"]["files"]]
    dae = {**result.dae, "source_map": {**result.dae["source_map"], "files": files}}
    whole = {"dae": dae, "flat": result.flat, "structural": sorted(result.structural)}
    return json.dumps(whole, separators=(",", ":")).encode()


def _recalled(sources: ModelSources, content: bytes) -> FrontEndResult:
    whole = json.loads(content)
    for entry in whole["dae"]["source_map"]["files"]:
        entry[1] = _with_root(sources, entry[1])
    return read_answer(sources, whole, frozenset(whole["structural"]))


def _without_root(sources: ModelSources, path: str) -> str:
    for number, root in enumerate(sources.roots):
        above = f"{root.resolve().as_posix()}/"
        if path.replace("\\", "/").startswith(above):
            return f"{_ROOT}{number}/{path[len(above) :]}"
    return path


def _with_root(sources: ModelSources, path: str) -> str:
    if not path.startswith(_ROOT):
        return path
    number, _, rest = path.removeprefix(_ROOT).partition("/")
    return f"{sources.roots[int(number)].resolve().as_posix()}/{rest}"
