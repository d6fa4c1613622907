"""What a study folder is told of a plan before the first run."""

from __future__ import annotations

from dse.exploration.samplers import requests
from dse.results.header import StudyHeader
from dse.testbench.plan import Plan


def header_of(planned: Plan) -> StudyHeader:
    """The header of the study folder for *planned*."""
    runs = len(requests(planned.study, tuple(planned.prepared)))
    return StudyHeader(planned.definition, planned.fingerprint, runs)
