"""Pages of plain HTML around the reports: the list of studies, two studies side by side, what went wrong."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from html import escape
from urllib.parse import quote

from dse.api import StudySummary
from dse.domain.bench import VERDICTS, Verdict
from dse.errors import DseError
from dse.report import HEAD, ICON, bundle, hash_of, script_json

_PAGE = (
    HEAD
    + """<script>{script}</script>
</head>
<body>
<header><h1>{title}</h1>{beside}<span class="spring"></span><button id="theme" type="button" hidden></button></header>
<main class="plain">
{body}
</main>
</body>
</html>
"""
)

_DRIVE = (
    HEAD
    + """</head>
<body>
<div id="drive"><noscript>This page needs JavaScript, which is switched off.</noscript></div>
<script type="application/json" id="document">{document}</script>
<script>{script}</script>
</body>
</html>
"""
)

CLASSES = {
    Verdict.PASS: "pass",
    Verdict.FAIL: "fail",
    Verdict.NOT_EXERCISED: "open",
    Verdict.FAILED_TO_RUN: "broken",
    Verdict.NOT_APPLICABLE: "muted",
}
"""How the style sheet calls the verdicts."""


def document(title: str, body: str, beside: str = "") -> str:
    """A page with the HTML *body*, and *beside* the plain text *title*. Its only code and style are its own."""
    script, style = bundle("serve.js"), bundle("serve.css")
    policy = (
        f"default-src 'none'; script-src '{hash_of(script)}'; style-src '{hash_of(style)}'; img-src data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'self'"
    )
    return _PAGE.format(
        policy=policy, title=escape(title), icon=ICON, style=style, script=script, beside=beside, body=body
    )


def drive_page(known: Mapping[str, object]) -> str:
    """The page of the test drive, which is told what is *known*: it asks for all else. Its only code is its own."""
    script, style = bundle("drive.js"), bundle("drive.css")
    policy = (
        f"default-src 'none'; script-src '{hash_of(script)}'; style-src '{hash_of(style)}' 'unsafe-inline'; "
        "img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'"
    )
    return _DRIVE.format(
        policy=policy, title="Test drive", icon=ICON, style=style, document=script_json(known), script=script
    )


def study_address(name: str) -> str:
    """Where the report of the study *name* is."""
    return f"/study/{quote(name)}/"


def start_page(place: str, studies: Mapping[str, StudySummary | DseError], *, is_rated: bool = False) -> str:
    """The list of *studies* by name, those that cannot be read with what is wrong; *place* is where they lie. If they
    are those of a rating, its page is linked."""
    running = sum(isinstance(each, StudySummary) and each.state == "running" for each in studies.values())
    beside = f'<span class="muted">{escape(place)} · {_count(len(studies), "study", "studies")}</span>'
    if not studies:
        empty = "<p>There is no study here yet. <code>dse explore STUDY -o out/STUDY</code> makes one.</p>"
        return document("Studies", f'<section class="card">{empty}</section>', beside)
    heads = "".join(f'<th scope="col">{each}</th>' for each in ("Study", "Runs", "Verdicts", "State", "Changed"))
    rows = "\n".join(_row(name, each) for name, each in studies.items())
    table = (
        f'<table class="studies"{" data-running" if running else ""}><thead><tr>'
        f'<th scope="col"><span class="unseen">Compare</span></th>{heads}</tr></thead><tbody>\n{rows}\n</tbody></table>'
    )
    compare = '<p class="hint">Tick two studies or more. <button type="submit">Compare</button></p>'
    form = f'<form action="/compare" method="get">{table}{compare if len(studies) > 1 else ""}</form>'
    if is_rated:
        beside += '<a href="/rating.html">Rating</a>'
    return document(
        "Studies", f'<section class="card">{form}</section>\n<section class="card">{_legend()}</section>', beside
    )


def problem_page(error: DseError) -> str:
    """What is wrong, in words."""
    told = "".join(
        f'<p class="problem">{escape(f"{each.where}: " if each.where else "")}{escape(each.what)}</p>'
        + (f'<p class="hint">{escape(each.hint)}</p>' if each.hint else "")
        for each in error.problems
    )
    return document("This cannot be shown", f'<section class="card">{told}</section>', home())


def home() -> str:
    """The way back to the list."""
    return '<a href="/">All studies</a>'


def verdict_bar(counts: Mapping[Verdict, int]) -> str:
    """How many runs came to each verdict, as a bar of as many parts and in words."""
    total = sum(counts.values())
    if not total:
        return '<span class="muted">no run yet</span>'
    parts, place = [], 0.0
    for verdict in VERDICTS:
        width = 100 * counts.get(verdict, 0) / total
        if width:
            parts.append(f'<rect class="{CLASSES[verdict]}" x="{place:.3f}" width="{width:.3f}" height="6"/>')
        place += width
    words = "".join(
        f'<span class="tally {CLASSES[verdict]}"><i aria-hidden="true"></i>{counts[verdict]:,} '
        f'<span class="muted">{verdict}</span></span>'
        for verdict in VERDICTS
        if counts.get(verdict)
    )
    bar = f'<svg class="bar" viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true">{"".join(parts)}</svg>'
    return f'{bar}<span class="tallies">{words}</span>'


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], kind: str = "plain") -> str:
    """A table whose heads and cells are HTML; the first cell of a row is its head."""
    head = "".join(f'<th scope="col">{each}</th>' for each in heads)
    body = "\n".join(
        f'<tr><th scope="row">{first}</th>{"".join(f"<td>{cell}</td>" for cell in rest)}</tr>' for first, *rest in rows
    )
    whole = f'<table class="{kind}"><thead><tr>{head}</tr></thead><tbody>\n{body}\n</tbody></table>'
    return f'<div class="scroll" tabindex="0">{whole}</div>'


def _row(name: str, study: StudySummary | DseError) -> str:
    shown = escape(name)
    if isinstance(study, DseError):
        what = escape(study.problems[0].what)
        return f'<tr><td></td><th scope="row">{shown}</th><td colspan="4"><span class="problem">{what}</span></td></tr>'
    tick = f'<input type="checkbox" name="study" value="{escape(name)}" aria-label="compare {shown}">'
    about = f"{study.study} on {study.bench}"
    if study.configurations > 1:
        about += f" · {study.configurations:,} configurations"
    title = (
        f'<a href="{escape(study_address(name))}">{escape(study.title)}</a>'
        f'<span class="muted">{escape(about)}</span><code>{shown}</code>'
    )
    share = 100 * study.finished / study.runs if study.runs else 0.0
    runs = (
        f"<span>{study.finished:,}<span class='muted'> of {study.runs:,}</span></span>"
        '<svg class="bar" viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true">'
        f'<rect class="done" width="{min(share, 100):.3f}" height="6"/></svg>'
    )
    state = f'<span class="badge {study.state.replace(" ", "-")}">{study.state}</span>'
    verdicts = verdict_bar(study.verdicts) if study.requirements else '<span class="muted">no requirements</span>'
    cells = "".join(
        f'<td data-head="{head}">{cell}</td>'
        for head, cell in (("Runs", runs), ("Verdicts", verdicts), ("State", state), ("Changed", _when(study.changed)))
    )
    return f'<tr><td>{tick}</td><th scope="row">{title}</th>{cells}</tr>'


def _when(changed: datetime) -> str:
    here = changed.astimezone()
    return f'<time datetime="{here.isoformat(timespec="seconds")}">{here:%Y-%m-%d %H:%M}</time>'


def _legend() -> str:
    return (
        '<p class="hint">A run passes if it meets all requirements; it is <b>not exercised</b> if one of them did not '
        "apply. The page shows the current content of the study folders and does not change it.</p>"
    )


def _count(number: int, one: str, many: str) -> str:
    return f"{number:,} {one if number == 1 else many}"
