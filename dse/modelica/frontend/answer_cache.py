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
from dse.modelica.frontend.sources import ModelSources
from dse.modelica.frontend.structural.probe import compile_probed


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
            whole = json.loads(content)
            return read_answer(sources, whole, frozenset(whole["structural"]))
        result = compile_probed(sources, structural)
        try_to_put(kept, _written(result))
        return result

    def _key(self, sources: ModelSources, structural: Mapping[str, Value]) -> str:
        given = {name: literal(value) for name, value in sorted(structural.items())}
        asked = json.dumps([self.program, VERSION, sources.model, list(given.items())])
        return content_key(
            [
                ("asked", asked.encode()),
                *((f"file/{name}", content) for name, content in sorted(sources.contents.items())),
                *((f"library/{name}", content) for name, content in sorted(sources.parts.items())),
            ]
        )


def _written(result: FrontEndResult) -> bytes:
    whole = {"dae": result.dae, "flat": result.flat, "structural": sorted(result.structural)}
    return json.dumps(whole, separators=(",", ":")).encode()
