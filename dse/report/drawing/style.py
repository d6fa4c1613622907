"""How everything looks in print, and how it becomes a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.errors import fail
from dse.report.verdicts import Mark
from dse.scratch import written_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# The page's colours (web/src/style/colours.css): apart under every common colour blindness, and each with its hatch.
COLOURS = ("#b54708", "#1f55c4", "#9c2a8f", "#0b7570", "#7a5c00", "#475467")
HATCHES = ("////", "\\\\\\\\", "---", "|||", "//..", "++")
INK, MUTED, FEASIBLE, PASS, BROKEN = "#1a222d", "#5c6877", "#d8eddf", "#12703f", "#c01048"
TARGET, CURRENT, LINE = "#d01f1f", "#1f55c4", "#dfe4ea"
STYLE: Any = {  # matplotlib types the keys as literals
    "font.size": 9,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.labelweight": "bold",
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.linewidth": 0.8,
    "xtick.color": INK,
    "ytick.color": INK,
    "hatch.linewidth": 0.7,
    "svg.hashsalt": "dse",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
}
MARKS: dict[Mark, dict[str, Any]] = {
    Mark.FAIL: {"marker": "o", "s": 3.5, "facecolors": INK, "edgecolors": "none"},
    Mark.NOT_EXERCISED: {"marker": "o", "s": 13, "facecolors": "white", "edgecolors": MUTED, "linewidths": 0.7},
    Mark.PASS: {"marker": "o", "s": 20, "facecolors": PASS, "edgecolors": "white", "linewidths": 0.6},
    Mark.FAILED_TO_RUN: {"marker": "x", "s": 28, "color": BROKEN, "linewidths": 1.6},
}
# Each format would otherwise carry the moment it was written, or matplotlib's version.
_METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": "dse"},
    ".pdf": {"CreationDate": None, "ModDate": None, "Creator": "dse", "Producer": None},
}


def save_drawing(figure: Figure, path: Path) -> None:
    """Write *figure* as PNG, SVG or PDF by the path's ending; the same figure gives the same bytes."""
    import matplotlib as mpl

    kind = path.suffix.lower()
    if kind not in _METADATA:
        raise fail(f"cannot write a figure as '{path.name}'", hint="end the name in .png, .svg or .pdf")
    with written_whole(path) as aside, mpl.rc_context(STYLE):
        figure.savefig(aside, format=kind[1:], dpi=200, metadata=_METADATA[kind])
