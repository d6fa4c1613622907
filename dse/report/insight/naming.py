"""Names of a study's files → what a reader calls them, and positions in the report."""

from __future__ import annotations

import re
from collections.abc import Mapping

from dse.domain.definition import StudyDefinition


class Naming:
    """Titles and positions of the variables, metrics, requirements and configurations of *definition*."""

    def __init__(self, definition: StudyDefinition) -> None:
        self._titles = {each.name: each.title for each in definition.variables if each.title}
        self.variables = _positions([each.name for each in definition.variables])
        self.metrics = _positions([each.name for each in definition.metrics if not each.error_of])
        self.requirements = _positions([each.name for each in definition.requirements])
        self.configurations = _positions([each.id for each in definition.configurations])
        # Only a path can be told from a word of the sentence.
        paths = sorted((name for name in self._titles if "." in name), key=len, reverse=True)
        names = "|".join(map(re.escape, paths))
        self._paths = re.compile(rf"(?<![\w.])(?:{names})(?![\w.]*\w)") if paths else None

    def titled(self, variable: str) -> str:
        """The title of a variable, or its name if it has none."""
        return self._titles.get(variable, variable)

    def spoken(self, sentence: str) -> str:
        """*sentence* with the titles of variables in place of their paths."""
        return self._paths.sub(lambda found: self._titles[found[0]], sentence) if self._paths else sentence

    def plane(self, names: tuple[str, ...]) -> tuple[int, ...]:
        """Positions of the variables *names*."""
        return tuple(self.variables[name] for name in names)

    def objectives(self, definition: StudyDefinition) -> list[str]:
        """The objectives in words: ``minimize energy per distance``."""
        titles = {each.name: each.title or each.name for each in definition.metrics}
        return [
            f"{'maximize' if each.maximize else 'minimize'} "
            + (f"total {each.name}" if each.is_total else titles.get(each.name, each.name))
            for each in definition.objectives
        ]


def _positions(names: list[str]) -> Mapping[str, int]:
    return {name: position for position, name in enumerate(names)}
