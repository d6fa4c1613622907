// Paints any chart on a canvas, as dse/report/drawing/chart.py does in print.
import { scaleLinear, scaleLog } from "d3-scale";
import type { Chart, ChartAxis, Drawn } from "../chart";
import type { Palette } from "../theme";
import { PASS } from "../verdicts";
import { clipTo, drawAxes, drawGrid, type Frame, type Scale } from "./frame";
import type { Pen } from "./pen";
import { drawShape, paintShape } from "./points";
import { colourOf } from "./regions";
import type { Sheet } from "./sheet";

// Beyond some thousand points a path of circles is slow, and no shape can be told any more.
const MOST_SHAPES = 4000;

export function paintChart({ pen, width, height }: Sheet, chart: Chart, colours: Palette): Frame {
  const frame = chartFrame(chart, width, height);
  pen.fillStyle = colours.plot;
  pen.fillRect(frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
  drawGrid(pen, frame, chart.x, chart.y, colours);
  chart.drawn.forEach((drawn, index) => {
    pen.save();
    if (drawn.kind !== "points") clipTo(pen, frame);
    paintDrawn(pen, frame, drawn, colourOf(colours, series(chart, index)), colours);
    pen.restore();
  });
  drawAxes(pen, frame, chart.x, chart.y, colours);
  return frame;
}

/** A small picture of how one entry of the chart is drawn, for its legend. */
export function paintKey({ pen, width, height }: Sheet, chart: Chart, index: number, colours: Palette): void {
  const drawn = chart.drawn[index]!;
  const colour = colourOf(colours, series(chart, index));
  if (drawn.kind === "points") {
    pen.beginPath();
    drawShape(pen, width / 2, height / 2, drawn.verdict ?? PASS, 1.2);
    paintPoints(pen, drawn.verdict, 1, colour, colours);
  } else if (drawn.kind === "bars" || drawn.kind === "band") {
    pen.globalAlpha = drawn.kind === "band" ? 0.3 : 1;
    pen.fillStyle = colour;
    pen.fillRect(1, 2, width - 2, height - 4);
  } else {
    pen.beginPath();
    pen.moveTo(0, height / 2);
    pen.lineTo(width, height / 2);
    stroke(pen, drawn.kind === "rule", colour, colours);
  }
}

export function insideAxes({ x, y }: Chart, a: number, b: number): boolean {
  return a >= x.low && a <= x.high && b >= y.low && b <= y.high;
}

// What has a colour of its own counts; bounds and verdicts always look the same.
function series(chart: Chart, index: number): number {
  return chart.drawn
    .slice(0, index)
    .filter((drawn) => drawn.kind !== "rule" && !(drawn.kind === "points" && drawn.verdict !== null)).length;
}

function chartFrame({ x, y }: Chart, width: number, height: number): Frame {
  const frame = { left: y.names.length ? 118 : 66, right: width - 16, top: 10, bottom: height - 50 };
  return { ...frame, x: scaleOf(x, frame.left, frame.right), y: scaleOf(y, frame.bottom, frame.top) };
}

function scaleOf({ log, low, high }: ChartAxis, from: number, to: number): Scale {
  return log ? scaleLog([low, high], [from, to]) : scaleLinear([low, high], [from, to]);
}

function paintDrawn(pen: Pen, frame: Frame, drawn: Drawn, colour: string, colours: Palette): void {
  const { x, y, left, right, top, bottom } = frame;
  pen.beginPath();
  switch (drawn.kind) {
    case "line":
    case "steps":
      trace(pen, frame, drawn.x, drawn.y, drawn.kind === "steps");
      stroke(pen, false, colour, colours, drawn.look);
      return;
    case "rule":
      if (drawn.axis === "x") {
        pen.moveTo(x(drawn.value), top);
        pen.lineTo(x(drawn.value), bottom);
      } else {
        pen.moveTo(left, y(drawn.value));
        pen.lineTo(right, y(drawn.value));
      }
      return stroke(pen, true, colour, colours);
    case "bars": {
      const floor = Math.min(bottom, y(Math.max(y.domain()[0]!, 0)));
      drawn.heights.forEach((height, i) => {
        if (Number.isNaN(height)) return;
        const from = x(drawn.edges[i]!);
        const gap = x(drawn.edges[i + 1]!) - from > 4 ? 1 : 0;
        pen.rect(from, y(height), x(drawn.edges[i + 1]!) - from - gap, floor - y(height));
      });
      pen.fillStyle = colour;
      return pen.fill();
    }
    case "band":
      for (const [start, end] of stretches(drawn.x, drawn.low, drawn.high)) {
        pen.moveTo(x(drawn.x[start]!), y(drawn.low[start]!));
        for (let i = start; i < end; i++) pen.lineTo(x(drawn.x[i]!), y(drawn.high[i]!));
        for (let i = end - 1; i >= start; i--) pen.lineTo(x(drawn.x[i]!), y(drawn.low[i]!));
      }
      pen.globalAlpha = 0.22;
      pen.fillStyle = colour;
      return pen.fill();
    case "points": {
      const spacing = Math.sqrt(((right - left) * (bottom - top)) / Math.max(1, drawn.x.length));
      const size = Math.min(1, Math.max(0.4, spacing / 22));
      const crowded = drawn.x.length > MOST_SHAPES;
      pen.fillStyle =
        drawn.verdict === null ? colour : [colours.pass, colours.ink, colours.muted, colours.broken][drawn.verdict]!;
      drawn.x.forEach((value, i) => {
        const [a, b] = [x(value), y(drawn.y[i]!)];
        // What lies beyond the axes is not drawn at their edge.
        if (!(a >= left && a <= right && b >= top && b <= bottom)) return;
        if (crowded) pen.fillRect(a - 1, b - 1, 2, 2);
        else drawShape(pen, a, b, drawn.verdict ?? PASS, size);
      });
      if (crowded) return;
      paintPoints(pen, drawn.verdict, size, colour, colours);
    }
  }
}

function paintPoints(pen: Pen, verdict: number | null, size: number, colour: string, colours: Palette): void {
  // A rim, as in the constraint plot, would wipe out neighbours that lie close.
  if (verdict !== null && verdict !== PASS) return paintShape(pen, verdict, size, colours);
  pen.fillStyle = verdict === PASS ? colours.pass : colour;
  pen.fill();
}

function stroke(
  pen: Pen,
  bound: boolean,
  colour: string,
  colours: Palette,
  look = { colour: bound ? colours.target : colour, width: 1.6, dash: bound ? [7, 5] : [] },
): void {
  pen.setLineDash(look.dash);
  pen.lineWidth = look.width;
  pen.lineJoin = "round";
  pen.strokeStyle = look.colour;
  pen.stroke();
}

function trace(pen: Pen, { x, y }: Frame, xs: Float64Array, ys: Float64Array, steps: boolean): void {
  for (const [start, end] of stretches(xs, ys, ys)) {
    pen.moveTo(x(xs[start]!), y(ys[start]!));
    for (let i = start + 1; i < end; i++) {
      if (steps) pen.lineTo(x(xs[i]!), y(ys[i - 1]!));
      pen.lineTo(x(xs[i]!), y(ys[i]!));
    }
  }
}

// From and to where all three have a value.
function stretches(...columns: [Float64Array, Float64Array, Float64Array]): [number, number][] {
  const found: [number, number][] = [];
  let start = -1;
  for (let i = 0; i <= columns[0].length; i++) {
    const known = i < columns[0].length && columns.every((column) => !Number.isNaN(column[i]));
    if (known && start < 0) start = i;
    if (!known && start >= 0) {
      found.push([start, i]);
      start = -1;
    }
  }
  return found;
}
