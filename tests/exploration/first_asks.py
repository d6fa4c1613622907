"""What studies ask for first."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

from fake_runners import definition_of

from dse.domain.component import Value
from dse.domain.run import RunRequest
from dse.domain.study import Study
from dse.exploration.scheduler import AskTellScheduler
from dse.storage.folder import StudyFolder


def first_ask(study: Study, configurations: tuple[str, ...]) -> list[RunRequest]:
    """The runs that a new *study* asks for first, numbered from 0."""
    definition = definition_of(study, configurations)
    with tempfile.TemporaryDirectory() as scratch, StudyFolder.create(Path(scratch), definition) as folder:
        asking = AskTellScheduler(study, folder)
        asking.ask()
        return list(asking.requests.values())


def points(study: Study) -> list[Mapping[str, Value]]:
    """The points that a new *study* asks for."""
    return [request.point for request in first_ask(study, ("a",))]
