import { thresholdsHere } from "../counts";
// The constraint plot: regions, runs and labels on one canvas, hover and selection on a second above it.
import { el } from "../dom";
import { number, withUnit } from "../format";
import type { Way } from "../plane/fields";
import type { Plane } from "../plane/plane";
import type { Changed, State, Store } from "../store";
import type { Study } from "../study";
import { type Palette, palette } from "../theme";
import type { Threshold } from "../verdicts";
import { senseOf } from "../views/designs/values";
import { drawColourBar } from "./colourbar";
import { path, type Ring } from "./contour";
import { drawAxes, type Frame, frameOf } from "./frame";
import { plotLegend } from "./key";
import { labelBoundary, labelRegion, type Spot } from "./labels";
import type { Pen, Shape } from "./pen";
import { paintPoints, placeOf } from "./points";
import { colourOf, paintRegions, type Regions, regionsOf, sameOpen, scaleOf } from "./regions";
import { paintedBy, type Sheet } from "./sheet";
import { wholeOf } from "./zoom";

export interface Plot {
  element: HTMLElement;
  surface: HTMLElement;
  plane(): Plane;
  frame(): Frame | null;
}

const REPAINTED: (keyof State)[] = [
  "configuration",
  "x",
  "y",
  "fixed",
  "thresholds",
  "fill",
  "theme",
  "brushes",
  "zoom",
];
const OVERLAID: (keyof State)[] = ["selected", "hovered", "pins"];

export function createPlot(store: Store): Plot {
  const ground = el("canvas", { class: "ground", "aria-hidden": "true" });
  const overlay = el("canvas", { class: "overlay", "aria-hidden": "true" });
  const surface = el(
    "div",
    {
      class: "plot",
      tabindex: 0,
      role: "application",
      "aria-roledescription": "constraint plot",
      "aria-label":
        "Constraint plot. Arrow keys select the neighbouring run, P pins it, plus and minus zoom, 0 shows the whole plane, Shift and an arrow key move it.",
      "aria-describedby": "announcement",
    },
    ground,
    overlay,
  );
  let frame: Frame | null = null;
  const plane = store.plane;

  const repaint = (): void => {
    const started = performance.now();
    paintGroundAgain();
    performance.measure("paint", { start: started, end: performance.now() });
    drawOverlay();
  };
  const paintGroundAgain = paintedBy(
    ground,
    (sheet) => {
      frame = paintGround(sheet, store, plane());
    },
    { legend: () => (frame ? plotLegend(store, frame) : []) },
  );
  const drawOverlay = paintedBy(overlay, (sheet) => {
    if (frame) paintOverlay(sheet, frame, store, plane());
  });

  store.subscribe((_, changed: Changed) => {
    if (REPAINTED.some((key) => changed.has(key))) repaint();
    else if (OVERLAID.some((key) => changed.has(key))) drawOverlay();
  });
  new ResizeObserver(repaint).observe(surface);
  return {
    element: surface,
    surface,
    plane,
    frame: () => frame,
  };
}

function paintGround({ pen, width, height }: Sheet, store: Store, plane: Plane): Frame {
  const { study, state } = store;
  const colours = palette();
  const points = store.points();
  const [horizontal, vertical] = [study.variables[plane.x]!, study.variables[plane.y]!];
  const metric = state.fill >= 0 && plane.fields ? study.metrics[state.fill]! : null;
  const frame = frameOf(width, height, state.zoom ?? wholeOf(study, plane), metric !== null, {
    x: horizontal,
    y: vertical,
  });
  pen.fillStyle = colours.plot;
  pen.fillRect(frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
  if (plane.fields) {
    const thresholds = thresholdsHere(store);
    const regions = regionsOf(study, plane.fields, thresholds, frame);
    const runs = plane.beside.length ? plane.beside : plane.on;
    const fill = metric
      ? { values: plane.fields.metric(state.fill, wayOf(store, state.fill)), scale: scaleOf(metric.values, runs) }
      : null;
    paintRegions(pen, frame, plane.fields, regions, fill, colours);
    if (metric && fill) drawColourBar(pen, frame, width, metric, fill.scale, colours);
    drawAxes(pen, frame, horizontal, vertical, colours);
    paintPoints(pen, frame, study, plane, points.judgement, points.within, colours);
    writeLabels(pen, frame, study, plane.fields, thresholds, regions, metric === null, colours);
  } else {
    drawAxes(pen, frame, horizontal, vertical, colours);
    paintPoints(pen, frame, study, plane, points.judgement, points.within, colours);
  }
  return frame;
}

function writeLabels(
  pen: Pen,
  frame: Frame,
  study: Study,
  fields: NonNullable<Plane["fields"]>,
  thresholds: Threshold[],
  regions: Regions,
  nameFeasible: boolean,
  colours: Palette,
): void {
  const on = study.requirements.map((_, index) => index).filter((index) => !thresholds[index]!.off);
  const taken: Spot[] = [];
  const { a, e, f } = pen.getTransform();
  const failing = path(regions.sides.flatMap(({ rings }) => rings));
  const inside = (shape: Shape, x: number, y: number): boolean => pen.isPointInPath(shape, a * x + e, a * y + f);
  for (const { requirement, limit, rings } of regions.sides) {
    const { title, unit } = study.metrics[study.requirements[requirement]!.metric]!;
    const blank = path([...regions.open[requirement]!, ...regions.unknown]);
    const visible = rings.map((ring) => ring.map((p) => (inside(blank, p[0], p[1]) ? [NaN, NaN] : p)) as Ring);
    const text = `${title} = ${withUnit(number(limit), unit)}`;
    const colour = colourOf(colours, requirement);
    const before = taken.length;
    // Beside the hatching the name reads best; on it, it still reads.
    labelBoundary(
      pen,
      frame,
      visible,
      text,
      colour,
      colours,
      taken,
      (x, y) => !inside(failing, x, y) && !inside(blank, x, y),
    );
    if (taken.length === before) {
      labelBoundary(pen, frame, visible, text, colour, colours, taken, (x, y) => !inside(blank, x, y));
    }
  }
  for (const group of sameOpen(regions.open)) {
    const exercised = fields.exercised(group[0]!)!;
    const names = group.length === on.length ? [] : group.map((index) => study.requirements[index]!.title);
    labelRegion(
      pen,
      frame,
      fields,
      (node) => exercised[node]! < 0.5,
      ["not exercised", ...names.slice(0, 3)],
      colours.plot,
      colours,
      taken,
    );
  }
  const known = fields.known(on);
  if (known) labelRegion(pen, frame, fields, (node) => known[node]! < 0.5, ["no result"], colours.plot, colours, taken);
  if (nameFeasible && on.length) {
    const met = on.length === study.requirements.length ? "all requirements met" : "requirements switched on are met";
    labelRegion(pen, frame, fields, meetsAll(study, fields, thresholds, on), [met], colours.feasible, colours, taken);
  }
}

function meetsAll(
  study: Study,
  fields: NonNullable<Plane["fields"]>,
  thresholds: Threshold[],
  on: number[],
): (node: number) => boolean {
  const known = fields.known(on);
  const parts = on.map((index) => ({
    most: fields.metric(study.requirements[index]!.metric, "max", index),
    least: fields.metric(study.requirements[index]!.metric, "min", index),
    exercised: fields.exercised(index),
    high: thresholds[index]!.atMost ?? Infinity,
    low: thresholds[index]!.atLeast ?? -Infinity,
  }));
  return (node) =>
    (!known || known[node]! >= 0.5) &&
    parts.every(
      ({ most, least, exercised, high, low }) =>
        most[node]! <= high && least[node]! >= low && (!exercised || exercised[node]! >= 0.5),
    );
}

/** What of a metric at several conditions is shown: its worst where a worse way is known. */
function wayOf(store: Store, metric: number): Way {
  const sense = senseOf(store, `metric.${metric}`);
  return sense === "min" ? "max" : sense === "max" ? "min" : "mean";
}

function paintOverlay({ pen }: Sheet, frame: Frame, store: Store, plane: Plane): void {
  const { study, state } = store;
  const colours = palette();
  const { first } = store.points();
  const shown = (selected: number): [number, number] | null => {
    const run = first(selected);
    if (run < 0 || (!plane.on.includes(run) && !plane.beside.includes(run))) return null;
    const [x, y] = placeOf(frame, study, plane, run);
    return x > frame.left - 1 && x < frame.right + 1 && y > frame.top - 1 && y < frame.bottom + 1 ? [x, y] : null;
  };
  const ring = ([x, y]: [number, number], radius: number, width: number, colour: string): void => {
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.strokeStyle = colours.plot;
    pen.lineWidth = width + 3;
    pen.stroke();
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.stroke();
  };
  drawBrushes(pen, frame, store, plane, colours);
  const selected = shown(state.selected);
  if (selected) {
    const [x, y] = selected;
    pen.strokeStyle = colours.ink;
    pen.lineWidth = 0.8;
    pen.globalAlpha = 0.45;
    pen.setLineDash([3, 3]);
    pen.beginPath();
    pen.moveTo(x, y + 10);
    pen.lineTo(x, frame.bottom);
    pen.moveTo(x - 10, y);
    pen.lineTo(frame.left, y);
    pen.stroke();
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }
  state.pins.forEach((pin, index) => {
    const place = shown(pin);
    if (!place) return;
    ring(place, 6, 3, colours.pins[index]!);
    pen.font = `600 11.5px ${colours.font}`;
    pen.textAlign = "left";
    pen.textBaseline = "middle";
    pen.lineWidth = 4;
    pen.strokeStyle = colours.plot;
    pen.strokeText(String(study.number[pin]), place[0] + 11, place[1]);
    pen.fillStyle = colours.ink;
    pen.fillText(String(study.number[pin]), place[0] + 11, place[1]);
  });
  const hovered = state.hovered === state.selected ? null : shown(state.hovered);
  if (hovered) ring(hovered, 7, 1.2, colours.ink);
  if (selected) ring(selected, 8, 2.2, colours.ink);
}

// Brushes of the two variables shown: a bar along the axis, and faint lines across the plane.
function drawBrushes(
  pen: Pen,
  { left, right, top, bottom, x, y }: Frame,
  { state }: Store,
  plane: Plane,
  colours: Palette,
): void {
  pen.strokeStyle = colours.accent;
  for (const { column, low, high } of state.brushes) {
    const [isX, isY] = [column === `variable.${plane.x}`, column === `variable.${plane.y}`];
    if (!isX && !isY) continue;
    const [scale, least, most] = isX ? [x, left, right] : [y, top, bottom];
    const ends = [scale(low), scale(high)].map((end) => Math.min(most, Math.max(least, end))) as [number, number];
    const line = (width: number, dash: number[], ...points: [number, number][]): void => {
      pen.lineWidth = width;
      pen.setLineDash(dash);
      pen.beginPath();
      points.forEach(([a, b], index) => (index ? pen.lineTo(a, b) : pen.moveTo(a, b)));
      pen.stroke();
    };
    if (isX) line(4, [], [ends[0], bottom + 2], [ends[1], bottom + 2]);
    else line(4, [], [left - 2, ends[0]], [left - 2, ends[1]]);
    for (const end of ends) {
      if (isX) line(1, [5, 4], [end, top], [end, bottom]);
      else line(1, [5, 4], [left, end], [right, end]);
    }
  }
  pen.setLineDash([]);
}
