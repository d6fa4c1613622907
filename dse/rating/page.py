"""One HTML page of a rating: points, and the matrices in the protocol's colours. Every text is escaped."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from html import escape
from itertools import groupby
from pathlib import Path

from dse.api import replay_file
from dse.rating.cases import described
from dse.rating.designs import RatedConfiguration, RatedDesign
from dse.rating.protocol import Cell
from dse.report import HEAD, ICON, hash_of
from dse.scratch import make_folder, write_whole

HEADING = "Predicted by simulation, not a rating"

_STYLE = """
:root{color-scheme:light dark}
body{font:15px/1.45 system-ui,sans-serif;margin:2rem auto;max-width:75rem;padding:0 1rem}
h1{font-size:1.5rem}h2{font-size:1.2rem;margin-top:2.5rem}h3{font-size:1rem;margin:1.5rem 0 .4rem}
table{border-collapse:collapse;margin:.5rem 0;display:block;overflow-x:auto;max-width:100%}
th,td{padding:.2rem .5rem;border:1px solid #8886;text-align:right;font-variant-numeric:tabular-nums}
td{white-space:nowrap}th{font-weight:600}th:first-child,td:first-child{text-align:left}
.matrix td{min-width:3rem;text-align:center}.matrix td.cell{color:#fff}
.matrix td.yellow,.matrix td.orange{color:#000}.matrix td.extended{outline:2px dashed #fff9;outline-offset:-4px}
.matrix a{color:inherit;text-decoration:none;display:block}.matrix a:focus,.matrix a:hover{outline:2px solid}
.note{border-left:4px solid #c80;padding:.3rem .8rem}
svg{max-width:100%}svg text{font:12px system-ui,sans-serif;fill:currentColor}
"""


def write_page(rated: RatedDesign, target: Path) -> None:
    """Write the page to *target*, whole or not at all. It asks nothing of the network. Raises DseError."""
    make_folder(target.parent)
    write_whole(target, page_of(rated, target.parent))


def page_of(rated: RatedDesign, folder: Path) -> str:
    """The page as text; links are relative to *folder*."""
    title = rated.rating.title or rated.rating.name
    # A class for each colour: the policy allows no style in an attribute.
    style = _STYLE + "".join(f".{name}{{background:{paint}}}\n" for name, paint in rated.protocol.paints.items())
    policy = f"default-src 'none'; style-src '{hash_of(style)}'; img-src data:; base-uri 'none'; form-action 'none'"
    head = HEAD.format(policy=policy, title=escape(f"{title}: {rated.design.name}"), icon=ICON, style=style)
    return head + "</head>\n<body>\n" + "\n".join(_body(rated, title, folder)) + "\n</body>\n</html>\n"


def _body(rated: RatedDesign, title: str, folder: Path) -> Iterator[str]:
    yield f"<h1>{HEADING}</h1>"
    package = f"{rated.protocol.name} {rated.protocol.version}"
    yield f"<p>{escape(title)}. Design space {escape(rated.design.name)}; calculator {escape(package)}.</p>"
    yield f'<p class="note">{escape(rated.not_assessed)}.'
    if rated.gaps:
        yield f"Not simulated, 0 points: {escape(rated.gaps)}."
    if rated.layers_left:
        yield f"Robustness layers that are not simulated: {escape(rated.layers_left)}."
    if rated.undeclared:
        yield f"0 points, as the rating does not declare: {escape(rated.undeclared)}."
    yield "</p><p>Numbers are values of the protocol's KPIs. A dashed line marks the extended range.</p>"
    if len(rated.rated) > 1:
        yield from _several(rated)
    for each in rated.best_first:
        yield from _one(rated, each, folder)


def _several(rated: RatedDesign) -> Iterator[str]:
    """Points of all configurations, over cost, and what the choices are worth."""
    best = rated.best_first
    places = rated.differing
    totals = [f"{s.element}: {s.subelement}" for s in best[0].filled.totals]
    heads = ["Configuration", *places, "Cost", "Points", *totals]
    rows = [
        [
            *(each.id, *(each.configuration.choices.get(place) or "–" for place in places)),
            *(each.cost_text, f"{each.filled.points:.3f}", *(f"{s.points:.3f}" for s in each.filled.totals)),
        ]
        for each in best
    ]
    yield "<h2>Configurations</h2>" + _table(heads, rows)
    if all(each.cost is not None for each in rated.rated):
        yield "<h2>Points over cost</h2>" + _plot(best)
    if effects := rated.effects():
        yield f"<h2>Points by choice (means over {len(best)} configurations)</h2>"
        shown = [[path, name or "absent", str(n), f"{effect:+.3f}"] for path, name, n, effect in effects]
        yield _table(["Place", "Choice", "Configurations", "Mean points less the mean of all"], shown)
    first, second = best[:2]
    flips = [[c.test, described(c), a or "–", b or "–"] for c, a, b in rated.differences(first, second)]
    yield f"<h2>Cells that differ: {escape(first.id)} and {escape(second.id)}</h2>"
    yield _table(["Test", "Cell", first.id, second.id], flips) if flips else "<p>None.</p>"


def _one(rated: RatedDesign, each: RatedConfiguration, folder: Path) -> Iterator[str]:
    filled = each.filled
    yield f"<h2>Configuration {escape(each.id)}: {filled.points:.3f} of {filled.most:g} points</h2>"
    yield f"<p>{escape(each.choices_text)}. Cost {escape(each.cost_text)}.</p>"
    yield from (f'<p class="note">Rule of the protocol: {escape(rule)}.</p>' for rule in filled.rules)
    if each.failed:
        yield f'<p class="note">Runs that failed, whose cells have no points: {len(each.failed)}.</p>'
    layers = [s for s in filled.scores if s.layer]
    rows = [
        [s.element, s.subelement, s.category, s.scenario, s.layer, f"{s.points:.3f}", f"{s.most:g}"] for s in layers
    ]
    yield "<details><summary>Points by scenario and layer</summary>"
    yield _table(["Stage element", "Stage subelement", "Category", "Scenario", "Layer", "Points", "of"], rows)
    yield "</details>"
    if each.prediction.layers:
        claims = sorted(each.prediction.layers)
        texts = (
            f"{layer} ({', '.join(s for _, s in of)})" for layer, of in groupby(claims, key=lambda claim: claim[0])
        )
        yield f"<p>Robustness layers claimed: {escape('; '.join(texts))}.</p>"
    for test, cells in groupby(rated.cells, key=lambda cell: cell.test):
        if test in rated.missing:
            yield f"<h3>{escape(test)}</h3><p>Not simulated.</p>"
        else:
            yield _matrix(rated, each, list(cells), folder)


def _matrix(rated: RatedDesign, each: RatedConfiguration, cells: Sequence[Cell], folder: Path) -> str:
    """The matrix of one test: rows and columns as in the protocol's workbook."""
    columns = sorted({cell.column for cell in cells})
    across = _varying(cells)
    down = [name for name in cells[0].attributes if name not in across]
    corner = f"{', '.join(down)} \\ {', '.join(across)}"
    heads = "".join(f"<th>{escape(_at(cells, c, across))}</th>" for c in columns)
    lines = [f"<tr><th>{escape(corner)}</th>{heads}</tr>"]
    for _, row in groupby(sorted(cells, key=lambda cell: (cell.row, cell.column)), key=lambda cell: cell.row):
        there = {cell.column: cell for cell in row}
        first = next(iter(there.values()))
        name = ", ".join(first.attributes[each] for each in down)
        drawn = "".join(_cell(rated, each, there[c], folder) if c in there else "<td></td>" for c in columns)
        lines.append(f"<tr><th>{escape(name)}</th>{drawn}</tr>")
    values = dict.fromkeys(f"{cell.kpi} in {rated.protocol.unit(cell.kpi)}".removesuffix(" in ") for cell in cells)
    most = f"{' or '.join(values)}, at most {rated.protocol.most_points(cells[0].test):g} points"
    return f'<h3>{escape(cells[0].test)}: {most}</h3><table class="matrix">{"".join(lines)}</table>'


def _varying(cells: Sequence[Cell]) -> tuple[str, ...]:
    """The attributes that tell the columns apart: those that are the same in every column, whatever the row."""
    by_column: dict[int, dict[str, set[str]]] = {}
    for cell in cells:
        for name, text in cell.attributes.items():
            by_column.setdefault(cell.column, {}).setdefault(name, set()).add(text)
    names = next(iter(by_column.values()))
    several = {name for name in names if len({cell.attributes.get(name) for cell in cells}) > 1}
    return tuple(n for n in names if n in several and all(len(each.get(n, ())) == 1 for each in by_column.values()))


def _at(cells: Sequence[Cell], column: int, names: Sequence[str]) -> str:
    cell = next(cell for cell in cells if cell.column == column)
    return ", ".join(cell.attributes[name] for name in names)


def _cell(rated: RatedDesign, each: RatedConfiguration, cell: Cell, folder: Path) -> str:
    run, colour = each.runs.get((cell.key, "")), each.prediction.colours.get(cell.key, "")
    unit = rated.protocol.unit(cell.kpi)
    if run is None or not colour:
        why = run.problem if run else "not simulated"
        return f'<td title="{escape(described(cell))}: {escape(why)}">–</td>'
    shown = f"{run.value:.2f}"
    hover = f"{cell.test}, {described(cell)}: {cell.kpi} {shown} {unit}, {colour}, run {run.number}"
    report = run.folder / "report.html"
    text = shown
    if report.is_file():
        text = f'<a href="{_address(report, folder)}#run={run.number}">{shown}</a>'
    replay = replay_file(run.folder, run.number)
    if replay.is_file():
        text += f'<a href="{_address(replay, folder)}">3-D</a>'
    extended = " extended" if cell.extended else ""
    return f'<td class="cell {colour}{extended}" title="{escape(hover)}">{text}</td>'


def _address(page: Path, folder: Path) -> str:
    return escape(Path(os.path.relpath(page, folder)).as_posix())


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [f"<tr>{''.join(f'<th>{escape(head)}</th>' for head in heads)}</tr>"]
    lines += [f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows]
    return f"<table>{''.join(lines)}</table>"


def _plot(rated: Sequence[RatedConfiguration]) -> str:
    """Points over cost, a mark for each configuration."""
    width, height, edge = 640, 320, 48
    costs, most = [each.cost or 0.0 for each in rated], rated[0].filled.most
    low, span = min(costs), (max(costs) - min(costs)) or 1.0
    marks = [
        f'<circle cx="{edge + (width - 2 * edge) * (cost - low) / span:.1f}" '
        f'cy="{height - edge - (height - 2 * edge) * each.filled.points / most:.1f}" r="5" fill="#36c">'
        f"<title>{escape(each.id)}: {each.filled.points:.3f} points, cost {escape(each.cost_text)}</title></circle>"
        for each, cost in zip(rated, costs, strict=True)
    ]
    axes = f'<path d="M{edge} {edge}V{height - edge}H{width - edge}" fill="none" stroke="currentColor"/>'
    labels = [
        (edge, height - 28, f"{low:g}"),
        (width - edge, height - 28, f"{max(costs):g}"),
        (width // 2, height - 10, "cost"),
    ]
    words = "".join(f'<text x="{x}" y="{y}" text-anchor="middle">{escape(text)}</text>' for x, y, text in labels)
    words += f'<text x="{edge - 8}" y="{height - edge}" text-anchor="end">0</text>'
    words += f'<text x="{edge - 8}" y="{edge + 4}" text-anchor="end">{most:g}</text>'
    words += f'<text x="{edge}" y="{edge - 12}">points</text>'
    return f'<svg viewBox="0 0 {width} {height}" width="{width}" role="img">{axes}{words}{"".join(marks)}</svg>'
