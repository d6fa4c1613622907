"""What is known of the FMUs of a system: facts that were found before, kept in the cache by the FMUs' content."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from dse.cache import cache_folder, is_damaged, put_file, vouch
from dse.domain.component import Component
from dse.domain.facts import PROBE_VERSION, Answer, FmuFacts, Question
from dse.domain.fmu import FmuModel
from dse.domain.system import SystemStructure
from dse.fmu import shares_nothing, this_platform


def known_facts(model: FmuModel, *, cache: Path | None = None) -> FmuFacts | None:
    """What is known of *model* on this platform, simulated in the manner that is asked for.

    None if it was not probed by this version of the experiments.
    """
    file = _file(model.content_hash, this_platform().name, model.manner, cache)
    if is_damaged(file):
        return None
    try:
        facts = _from_json(json.loads(file.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, KeyError):
        return None  # absent or not ours: to be found again
    vouch(file)
    return facts


def keep_facts(facts: FmuFacts, *, cache: Path | None = None) -> Path:
    """Write *facts* where `known_facts` finds them. Raises DseError if the cache cannot be written."""
    text = json.dumps(facts_as_data(facts), indent=1, sort_keys=True) + "\n"
    return put_file(_file(facts.content_hash, facts.platform, facts.interface, cache), text.encode())


class KnownFmus:
    """What is known of the FMUs of systems; each FMU is looked up once."""

    def __init__(self, cache: Path | None = None) -> None:
        self._cache = cache
        self._facts: dict[tuple[str, str], FmuFacts | None] = {}
        self._shares_nothing: dict[Path, bool] = {}

    def facts_of(self, system: SystemStructure) -> dict[str, FmuFacts]:
        """What is known of the elements of *system*, by their names."""
        known = {element.name: self._known(element.model) for element in system.elements if element.model.content_hash}
        return {name: facts for name, facts in known.items() if facts}

    def is_thread_safe(
        self, system: SystemStructure, facts: Mapping[str, FmuFacts], parts: Mapping[str, Component]
    ) -> bool:
        """Whether *system* may be simulated several times at once in threads of one process.

        Its FMUs were seen to bear it; or they are built from source here, without static variables, so that instances
        share nothing, and nothing else was seen. *parts* are the components by element.
        """
        return all(self._supports_threads(e.model, facts.get(e.name), parts.get(e.name)) for e in system.elements)

    def _known(self, model: FmuModel) -> FmuFacts | None:
        key = model.content_hash, model.manner
        if key not in self._facts:
            self._facts[key] = known_facts(model, cache=self._cache)
        return self._facts[key]

    def _supports_threads(self, model: FmuModel, facts: FmuFacts | None, component: Component | None) -> bool:
        if model.capabilities.once_per_process:
            return False
        if facts is not None and facts.answer(Question.THREADS) is not Answer.UNKNOWN:
            limited = facts.denies(Question.RENEWS) or facts.denies(Question.LASTS)
            return facts.answer(Question.THREADS) is Answer.YES and not limited
        source = component.source if component is not None else None
        if source is None or source.is_finished:
            return False
        if model.folder not in self._shares_nothing:
            self._shares_nothing[model.folder] = shares_nothing(model, cache=self._cache)
        return self._shares_nothing[model.folder]


def consequences(facts: FmuFacts) -> tuple[str, ...]:
    """What dse does with an FMU of which this is known, in words."""
    if facts.denies(Question.RUNS):
        return ("cannot be simulated as it is",)
    said = []
    if facts.denies(Question.RESETS):
        said.append("is made anew before every run, never reset")
    if facts.denies(Question.RENEWS):
        said.append("has a process of its own for every run")
    if facts.denies(Question.COEXISTS):
        said.append("may be in one place of a design only")
    if facts.denies(Question.SAVES):
        said.append("is refused by adaptive steps")
    if facts.answer(Question.THREADS) is not Answer.YES:
        said.append("is simulated in processes, not in threads")
    if facts.most_instances is not None:
        said.append(f"has its process renewed in time, as it died after {facts.instances} instances")
    return tuple(said)


def facts_as_data(facts: FmuFacts) -> dict[str, Any]:
    """*facts* as JSON data; what was not measured is null."""
    data = asdict(facts)
    data |= {name: None for name, value in data.items() if isinstance(value, float) and math.isnan(value)}
    words = {name: {str(question): str(text) for question, text in data[name].items()} for name in _BY_QUESTION}
    return data | words


_BY_QUESTION = ("answers", "reasons")


def _from_json(data: Mapping[str, Any]) -> FmuFacts:
    values = {f.name: data[f.name] for f in fields(FmuFacts)}
    values |= {name: math.nan for name, value in values.items() if value is None}
    values["answers"] = {q: Answer(data["answers"][q]) for q in Question if q in data["answers"]}
    values["reasons"] = {q: str(data["reasons"][q]) for q in Question if q in data["reasons"]}
    return FmuFacts(**values)


def _file(content: str, platform: str, interface: str, cache: Path | None) -> Path:
    return cache_folder(cache) / "facts" / f"{content[:32]}-{interface}-{platform}-{PROBE_VERSION}.json"
