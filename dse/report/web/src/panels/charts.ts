// The study's figures: every chart with a read-out; a click or the arrow keys select the run of a point.
import { selectRun } from "../actions";
import type { Chart, ChartAxis, Charted } from "../chart";
import { append, el } from "../dom";
import { number, withUnit } from "../format";
import { insideAxes, paintChart, paintKey } from "../plot/chart";
import { axisText, type Frame } from "../plot/frame";
import { SIGN } from "../plot/legend";
import type { Pen } from "../plot/pen";
import { fit, paintedBy, type Sheet } from "../plot/sheet";
import type { Store } from "../store";
import { palette } from "../theme";

const REACH = 24;

/** What can be pointed at: places in the units of the axes, and positions of runs or -1. */
interface Places {
  x: number[];
  y: number[];
  run: number[];
  label: string[];
}

export function createCharts(store: Store): HTMLElement {
  const rows = new Map(Array.from(store.study.number, (run, row) => [run, row]));
  const box = el("div", { class: "charted" });
  for (const figure of store.study.charted) append(box, el("h3", {}, figure.title), content(store, figure, rows));
  const hint =
    "Click a point, or move with the arrow keys, to select its run. Bounds and verdicts here are those of the study, independent of the sliders.";
  append(box, el("p", { class: "hint" }, hint));
  return box;
}

function content(store: Store, { problem, charts }: Charted, rows: Map<number, number>): HTMLElement {
  if (problem) return el("p", { class: "problem" }, problem);
  return el("div", { class: "sheets" }, ...charts.map((chart) => createChart(store, chart, rows)));
}

function createChart(store: Store, chart: Chart, rows: Map<number, number>): HTMLElement {
  const places = placesOf(chart, rows);
  const selects = places.run.some((run) => run >= 0);
  const order = places.x
    .map((_, index) => index)
    .sort((a, b) => places.x[a]! - places.x[b]! || places.y[a]! - places.y[b]!);
  const ground = el("canvas", { "aria-hidden": "true" });
  const overlay = el("canvas", { "aria-hidden": "true" });
  const surface = el(
    "div",
    {
      class: "sheet",
      tabindex: 0,
      role: "application",
      "aria-roledescription": "chart",
      "aria-label": description(chart, places, selects),
    },
    ground,
    overlay,
  );
  // Selecting a run is announced by the page; only what selects nothing is read out here.
  const reading = el("p", { class: "reading", ...(selects ? {} : { "aria-live": "polite" }) });
  const keys = chart.drawn
    .map(({ label }, index) =>
      label ? { label, index, canvas: el("canvas", { class: "symbol", "aria-hidden": "true" }) } : null,
    )
    .filter((key) => key !== null);
  let frame: Frame | null = null;
  let cursor = -1;

  const here = (): number =>
    cursor >= 0 ? cursor : selects && store.state.selected >= 0 ? places.run.indexOf(store.state.selected) : -1;
  const paintGround = paintedBy(
    ground,
    (sheet) => {
      frame = paintChart(sheet, chart, palette());
    },
    {
      title: () => chart.title,
      legend: () =>
        keys.map(({ label, index }) => ({ text: label, draw: (pen, x, y) => keyAt(pen, x, y, chart, index) })),
    },
  );
  const paintPoint = paintedBy(overlay, (sheet) => {
    if (frame) paintOverlay(sheet, frame, places, places.run.indexOf(store.state.selected), cursor);
  });
  const point = (): void => {
    paintPoint();
    reading.textContent = here() < 0 ? "\u00a0" : read(store, chart, places, here());
  };
  const repaint = (): void => {
    const colours = palette();
    paintGround();
    for (const { canvas, index } of keys) paintKey(fit(canvas), chart, index, colours);
    point();
  };
  const move = (index: number): void => {
    cursor = index;
    point();
  };
  const choose = (index: number): void => {
    const run = places.run[index] ?? -1;
    if (run >= 0) selectRun(store, run);
    move(run >= 0 ? -1 : index);
  };
  const at = (event: MouseEvent): number => {
    const { left, top } = surface.getBoundingClientRect();
    return frame ? nearest(frame, places, event.clientX - left, event.clientY - top) : -1;
  };
  surface.addEventListener("pointermove", (event) => move(at(event)));
  surface.addEventListener("pointerleave", () => move(-1));
  surface.addEventListener("click", (event) => {
    const index = at(event);
    if (index >= 0) choose(index);
  });
  surface.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey || !order.length) return;
    const from = order.indexOf(here());
    const last = order.length - 1;
    const to = { ArrowLeft: from < 0 ? last : from - 1, ArrowRight: from + 1, Home: 0, End: last }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    choose(order[Math.min(last, Math.max(0, to))]!);
  });
  store.subscribe((_, changed) => {
    if (changed.has("theme")) repaint();
    else if (changed.has("selected")) point();
  });
  new ResizeObserver(repaint).observe(surface);
  return el(
    "figure",
    {},
    el("figcaption", {}, el("b", {}, chart.title)),
    surface,
    el("ul", { class: "legend" }, ...keys.map(({ label, canvas }) => el("li", {}, canvas, el("span", {}, label)))),
    reading,
    chart.note && el("p", { class: "hint" }, chart.note),
  );
}

// Points if there are any; else the corners of everything else.
function placesOf(chart: Chart, rows: Map<number, number>): Places {
  const places: Places = { x: [], y: [], run: [], label: [] };
  const add = (x: number, y: number, label: string, run = -1): void => {
    if (!insideAxes(chart, x, y)) return;
    places.x.push(x);
    places.y.push(y);
    places.run.push(run);
    places.label.push(label);
  };
  for (const drawn of chart.drawn) {
    if (drawn.kind === "points")
      drawn.x.forEach((x, i) => add(x, drawn.y[i]!, drawn.label, rows.get(drawn.runs[i]!) ?? -1));
  }
  if (places.x.length) return places;
  for (const drawn of chart.drawn) {
    const { label } = drawn;
    if (drawn.kind === "line" || drawn.kind === "steps") drawn.x.forEach((x, i) => add(x, drawn.y[i]!, label));
    else if (drawn.kind === "bars")
      drawn.heights.forEach((height, i) => add((drawn.edges[i]! + drawn.edges[i + 1]!) / 2, height, label));
    else if (drawn.kind === "band") {
      for (const edge of [drawn.low, drawn.high]) drawn.x.forEach((x, i) => add(x, edge[i]!, label));
    }
  }
  return places;
}

function nearest({ x, y }: Frame, places: Places, a: number, b: number): number {
  let best = -1;
  let least = REACH * REACH;
  for (let index = 0; index < places.x.length; index++) {
    const square = (x(places.x[index]!) - a) ** 2 + (y(places.y[index]!) - b) ** 2;
    if (square < least) {
      least = square;
      best = index;
    }
  }
  return best;
}

function read({ study }: Store, chart: Chart, { x, y, run, label }: Places, index: number): string {
  const parts = [value(chart.x, x[index]!), value(chart.y, y[index]!)];
  if (label[index]) parts.unshift(label[index]!);
  if (run[index]! >= 0) parts.unshift(`Run ${study.number[run[index]!]}`);
  return parts.join(" \u00b7 ");
}

function value(axis: ChartAxis, at: number): string {
  return axis.names.length ? (axis.names[Math.round(at)] ?? "") : `${axis.title} ${withUnit(number(at), axis.unit)}`;
}

function description(chart: Chart, places: Places, selects: boolean): string {
  const labels = chart.drawn.map(({ label }) => label).filter(Boolean);
  const keys = selects ? "Arrow keys select the run of the next point." : "Arrow keys read the next value.";
  return [
    `${chart.title}: ${axisText(chart.y)} over ${axisText(chart.x)}, ${places.x.length} points`,
    ...(labels.length ? [labels.join(", ")] : []),
    keys,
  ].join(". ");
}

function keyAt(pen: Pen, x: number, y: number, chart: Chart, index: number): void {
  const [width, height] = [SIGN, 10];
  pen.translate(x - width / 2, y - height / 2);
  paintKey({ pen, width, height }, chart, index, palette());
}

function paintOverlay({ pen }: Sheet, frame: Frame, places: Places, selected: number, hovered: number): void {
  const colours = palette();
  for (const [index, width] of [
    [hovered, 1.2],
    [selected, 2.2],
  ] as const) {
    if (index < 0) continue;
    pen.beginPath();
    pen.arc(frame.x(places.x[index]!), frame.y(places.y[index]!), 6 + width, 0, 2 * Math.PI);
    pen.strokeStyle = colours.plot;
    pen.lineWidth = width + 3;
    pen.stroke();
    pen.strokeStyle = colours.ink;
    pen.lineWidth = width;
    pen.stroke();
  }
}
