"""What all pictures are drawn with: boxes with a label, curves, and the sheet around them, as SVG 1.1 text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

TEXT_STYLE = 'text { font: 12px system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; fill: #1c2733; }'


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle: left edge, middle, width and height, in pixels."""

    x: float
    middle: float
    width: float
    height: float

    @property
    def top(self) -> float:
        """Its upper edge."""
        return self.middle - self.height / 2

    @property
    def right(self) -> float:
        """Its right edge."""
        return self.x + self.width


def sheet(width: float, height: float, name: str, style: str, content: Iterable[str]) -> str:
    """The whole picture: *content* on white; *style* is CSS."""
    return "\n".join(
        [
            (
                f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}"'
                f' viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label={quoteattr(name)}>'
            ),
            f"<style>\n{TEXT_STYLE}{style}</style>",
            f'<rect width="{width:.0f}" height="{height:.0f}" fill="#ffffff"/>',
            *content,
            "</svg>\n",
        ]
    )


def rectangle(box: Box, rounding: int, attributes: str = "") -> str:
    """A box without a label."""
    return (
        f'<rect{attributes} x="{box.x:.1f}" y="{box.top:.1f}" width="{box.width:.1f}" height="{box.height:.1f}"'
        f' rx="{rounding}"/>'
    )


def labelled(classes: str, box: Box, label: str, rounding: int = 4, title: str = "") -> str:
    """A box with *label* in its middle; *title* is an element that is shown when one points at it."""
    middle = f'x="{box.x + box.width / 2:.1f}" y="{box.middle + 4:.1f}" text-anchor="middle"'
    return f'<g class="{classes}">{title}{rectangle(box, rounding)}<text {middle}>{escape(label)}</text></g>'


def curve(*points: tuple[float, float]) -> str:
    """The path of a cubic Bézier curve."""
    start, *others = (f"{x:.1f} {y:.1f}" for x, y in points)
    return f"M{start} C{' '.join(others)}"
