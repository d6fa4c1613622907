"""What is kept with a study besides its runs, as the page reads it: its files, its design space, tries made again."""

from __future__ import annotations

import re

from dse.domain.provenance import Funnel, Provenance
from dse.report.content.data import ReportContent

Json = dict[str, object]

_MOST_RUNS = 8
_MOST_CAUSES = 12
_TURNING = re.compile("[\u200e\u200f\u061c\u202a-\u202e\u2066-\u2069]")


def notes_of(content: ReportContent) -> Json:
    """Part of the document; of tries made again the most frequent causes, each with its first runs."""
    causes = sorted(content.retried, key=lambda each: (-len(each.runs), each.cause))
    return {
        "notes": _notes(content.notes) if content.notes else None,
        "retried": [
            {"cause": each.cause, "count": len(each.runs), "runs": list(each.runs[:_MOST_RUNS])}
            for each in causes[:_MOST_CAUSES]
        ],
    }


def _notes(notes: Provenance) -> Json:
    sources = [
        {"kind": each.kind, "file": each.file, "text": _spelt(each.text), "digest": each.digest}
        for each in notes.sources
    ]
    return {
        "sources": sources,
        "funnel": _funnel(notes.funnel) if notes.funnel else None,
        "unfunnelled": notes.unfunnelled,
        "assumed": notes.assumed,
    }


def _spelt(text: str) -> str:
    """*text* with marks that turn what stands after them spelt out: the page drops them, and a file has them."""
    return _TURNING.sub(lambda mark: f"\\u{ord(mark[0]):04x}", text)


def _funnel(funnel: Funnel) -> Json:
    return {
        "design": funnel.design,
        "count": funnel.count,
        "text": funnel.text,
        "steps": [
            {
                "constraint": each.constraint,
                "because": each.because,
                "rule": each.rule,
                "count": each.count,
                "text": each.text,
            }
            for each in funnel.steps
        ],
        "absent": [
            {"place": each.place, "choice": each.choice, "constraints": list(each.constraints)}
            for each in funnel.absent
        ],
    }
