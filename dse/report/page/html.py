"""One offline HTML file from ReportContent: no network, no inline code but its own, by hash."""

from __future__ import annotations

import base64
import hashlib
import html
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path

from dse.errors import Problem, fail
from dse.report.content.data import ReportContent
from dse.report.figure import ShownFigure, shown_figures
from dse.report.page.payload import payload_of, script_json
from dse.report.page.simulation import POLICY, PageSimulation
from dse.scratch import write_whole

HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="dse">
<title>{title}</title>
<link rel="icon" href="{icon}">
<style>{style}</style>
"""
"""How each page of ours begins."""

_PAGE = (
    HEAD
    + """</head>
<body>
<div id="page"><noscript>This report draws itself with JavaScript, which is switched off.</noscript></div>
<script type="application/json" id="document">{document}</script>
<script type="application/octet-stream;base64" id="columns">{columns}</script>
<script type="application/octet-stream;base64" id="waveforms">{waveforms}</script>{live}{simulation}
<script>{script}</script>
</body>
</html>
"""
)

ICON = "data:image/svg+xml;base64," + base64.b64encode(
    b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 16 16"><rect width="16" height="16" rx="3" fill="#1f4e9e"/>'
    b'<path d="M3 13 Q8 11 13 4" stroke="#fff" stroke-width="2" fill="none"/></svg>'
).decode("ascii")


def write_report(content: ReportContent, target: Path, simulation: PageSimulation | None = None) -> tuple[Problem, ...]:
    """Write the page to *target*, whole or not at all. Raises DseError if the file or the bundle cannot be used.

    With a *simulation* it can simulate. Returns the problems of figures that could not be drawn; the page names them in
    their place.
    """
    shown = shown_figures(content)
    text = page_of(content, shown, simulation=simulation)
    write_whole(target, text)
    return tuple(figure.problem for figure in shown if figure.problem)


def served_page(content: ReportContent, live: Mapping[str, object]) -> str:
    """The page as a server gives it: *live* tells its script whom to ask how the study is getting on."""
    entry = f'\n<script type="application/json" id="live">{script_json(live)}</script>'
    return page_of(content, shown_figures(content), entry)


def page_of(
    content: ReportContent,
    shown: Sequence[ShownFigure] = (),
    live: str = "",
    simulation: PageSimulation | None = None,
) -> str:
    """The page as text, with the figures *shown*; the same content gives the same text.

    With the script element *live* it may ask the server it came from, with a *simulation* it can simulate.
    """
    script, style = bundle("report.js"), bundle("report.css")
    payload = payload_of(content, shown)
    compiled, workers = POLICY if simulation else ("", "")
    policy = (
        f"default-src 'none'; script-src '{hash_of(script)}'{compiled}; style-src '{hash_of(style)}'; "
        "img-src data:; base-uri 'none'; form-action 'none'" + ("; connect-src 'self'" if live else "") + workers
    )
    return _PAGE.format(
        policy=policy,
        title=html.escape(content.title),
        icon=ICON,
        style=style,
        document=payload.document,
        columns=payload.columns,
        waveforms=payload.waveforms,
        live=live,
        simulation=simulation.elements(bundle("simulate.js")) if simulation else "",
        script=script,
    )


def bundle(name: str) -> str:
    """A file that was bundled of the web sources. Raises DseError if it is not there."""
    source = files("dse.report").joinpath("web", "dist", name)
    try:
        text = source.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise fail(
            f"the report's web bundle is missing ({name})",
            hint="install the package again, or run 'npm ci' and 'npm run build' in dse/report/web",
        ) from error
    # The hash in the policy is over what the browser reads, and browsers read CR LF as LF.
    return text.replace("\r\n", "\n")


def hash_of(text: str) -> str:
    """What a content security policy calls the inline script or style *text*."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")
