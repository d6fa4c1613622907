"""The page of two or more studies side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

from dse.api import Compared, difference, flip_counts, quantity
from dse.domain.bench import Verdict
from dse.serving.pages import CLASSES, document, home, study_address, table, verdict_bar

_MOST_FLIPS = 200


def compare_page(comparison: Mapping[str, Compared]) -> str:
    """The studies of *comparison* by name, each beside the first."""
    names, studies = list(comparison), list(comparison.values())
    parts = [_card("Verdicts", _counts(names, studies))]
    for name, study in list(comparison.items())[1:]:
        parts.append(_card(f"{names[0]} → {name}", _changes(names[0], study)))
    beside = f'<span class="muted">{escape(", ".join(names))}</span>{home()}'
    return document("Compare", "\n".join(parts), beside)


def _card(title: str, body: str) -> str:
    return f'<section class="card"><h2>{escape(title)}</h2>{body}</section>'


def _counts(names: Sequence[str], studies: Sequence[Compared]) -> str:
    heads = [
        f'<a href="{escape(study_address(name))}">{escape(name)}</a>'
        f'<span class="muted">{escape(each.definition.title)}</span>'
        for name, each in zip(names, studies, strict=True)
    ]
    requirements = dict.fromkeys(name for each in studies for name in each.verdicts)
    titles = {entry.name: entry.title for each in studies for entry in each.definition.requirements}
    rows = [["runs", *(f"{each.finished:,}<span class='muted'> of {each.runs:,}</span>" for each in studies)]]
    for name in requirements:
        label = escape(name) + (f'<span class="muted">{escape(titles[name])}</span>' if titles[name] != name else "")
        rows.append([label, *(_bar(each, name) for each in studies)])
    return table(("", *heads), rows)


def _bar(study: Compared, requirement: str) -> str:
    counts = study.verdicts.get(requirement)
    if counts is None:
        return '<span class="muted">has no such requirement</span>'
    return verdict_bar({Verdict(word): count for word, count in counts.items()})


def _changes(first: str, study: Compared) -> str:
    changed = "".join(f"<li>{escape(each)}</li>" for each in study.changed)
    parts = [f"<h3>What changed</h3><ul>{changed}</ul>" if changed else "<p>Nothing in their definitions differs.</p>"]
    parts.append("<h3>Verdicts that flipped</h3>")
    parts.append(
        f"<p>{study.shared:,} of {study.finished:,} runs have the configuration and point of a run of "
        f"{escape(first)}; {len(study.flips):,} of their verdicts differ.</p>"
    )
    if study.flips:
        rows = [
            (escape(name), _badge(was), _badge(now), f"{count:,}")
            for (name, was, now), count in flip_counts(study).items()
        ]
        parts.append(table(("Requirement", "was", "is", "runs"), rows, "plain numbers"))
        parts.append(_flips(study))
    return "".join(parts)


def _flips(study: Compared) -> str:
    variables = [each for each in study.definition.variables if any(each.name in flip.point for flip in study.flips)]
    units = {entry.name: entry.unit for entry in study.definition.requirements}
    heads = ["Runs", "Requirement", "was", "is", "Margin was", "Margin is"]
    if len(study.definition.configurations) > 1:
        heads.append("Configuration")
    heads += [escape(each.title or each.name) for each in variables]
    rows = []
    for flip in study.flips[:_MOST_FLIPS]:
        margins = (difference(margin, units[flip.requirement]) for margin in flip.margins)
        row = [f"{flip.numbers[0]} → {flip.numbers[1]}", escape(flip.requirement), *map(_badge, flip.verdicts)]
        row += map(escape, margins)
        if len(study.definition.configurations) > 1:
            row.append(f"<code>{escape(flip.configuration)}</code>")
        row += [escape(_shown(flip.point.get(each.name), each.unit)) for each in variables]
        rows.append(row)
    more = len(study.flips) - len(rows)
    told = f'<p class="hint">and {more:,} more: <code>dse compare --format json</code> has all</p>' if more > 0 else ""
    return f"<details><summary>One by one</summary>{table(heads, rows, 'plain numbers')}{told}</details>"


def _shown(value: object, unit: str) -> str:
    if value is None:
        return "–"
    return quantity(float(value), unit) if isinstance(value, int | float) else str(value)


def _badge(verdict: Verdict) -> str:
    return f'<span class="badge {CLASSES[verdict]}">{verdict}</span>'
