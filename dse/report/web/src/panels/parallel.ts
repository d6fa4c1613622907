// Every run as a line across all variables and metrics; a click selects the nearest line.
import { scaleLinear, type ScaleLinear } from "d3-scale";
import { selectRun } from "../actions";
import { el, fit } from "../dom";
import { group, number } from "../format";
import { colourOf } from "../plot/regions";
import type { Store } from "../store";
import { axisLabel, type Study } from "../study";
import { palette, type Palette } from "../theme";
import { PASS } from "../verdicts";
import { scope } from "./summary";

const MOST_LINES = 1500;
const TOP = 40;
const FOOT = 22;
const SIDE = 78;

interface Axis {
  title: string;
  values: Float64Array;
  metric: number;
  low: number;
  high: number;
}

export function createParallel(store: Store): HTMLElement {
  const { study } = store;
  const axes = axesOf(study);
  const canvas = el("canvas", { class: "parallel", role: "img", "aria-label": "Every run as a line across all design variables and metrics; the table below has the same numbers" });
  const note = el("p", { class: "hint" });
  let lines: number[] = [];
  const draw = (): void => {
    const wanted = scope(store);
    const runs = Array.from(study.number.keys()).filter((run) => study.done[run] && (wanted < 0 || study.configuration[run] === wanted));
    const stride = Math.max(1, Math.ceil(runs.length / MOST_LINES));
    lines = runs.filter((_, i) => i % stride === 0);
    const share = stride > 1 ? `${group(lines.length)} of ${group(runs.length)} runs are drawn. ` : "";
    note.textContent = `${share}Green lines meet every requirement, the thick line is the selected run, marks are the thresholds. Click a line to select its run.`;
    paint(canvas, store, axes, lines);
  };
  canvas.addEventListener("click", (event) => {
    const run = nearest(canvas, axes, lines, event.offsetX, event.offsetY);
    if (run >= 0) selectRun(store, run);
  });
  store.subscribe((_, changed) => {
    if (changed.has("thresholds") || changed.has("selected") || changed.has("configuration") || changed.has("theme")) draw();
  });
  new ResizeObserver(draw).observe(canvas);
  return el("div", {}, canvas, note);
}

// A metric's axis spans the bulk of its values, so that one wild run does not flatten the others.
function axesOf(study: Study): Axis[] {
  const variables = study.variables.map((variable) => ({ title: axisLabel(variable), values: variable.values, metric: -1, low: variable.low, high: variable.high }));
  const metrics = study.metrics.map((column, metric) => {
    const sorted = column.values.filter((value, run) => Number.isFinite(value) && study.done[run] === 1).sort();
    const at = (part: number): number => sorted[Math.round(part * (sorted.length - 1))] ?? 0;
    const [low, high] = [at(0.01), at(0.99)];
    return { title: axisLabel(column), values: column.values, metric, low, high: high > low ? high : low + 1 };
  });
  return [...variables, ...metrics];
}

function scales(axes: Axis[], height: number): ScaleLinear<number, number>[] {
  return axes.map(({ low, high }) => scaleLinear([low, high], [height - FOOT, TOP]).clamp(true));
}

function place(axes: Axis[], width: number, index: number): number {
  return SIDE + (index * (width - 2 * SIDE)) / Math.max(1, axes.length - 1);
}

function paint(canvas: HTMLCanvasElement, store: Store, axes: Axis[], lines: number[]): void {
  const { pen, width, height } = fit(canvas);
  const colours = palette();
  const heights = scales(axes, height);
  const { overall } = store.judgement();
  const add = (run: number): void => {
    let started = false;
    axes.forEach(({ values }, index) => {
      const value = values[run]!;
      if (!Number.isFinite(value)) started = false;
      else if (started) pen.lineTo(place(axes, width, index), heights[index]!(value));
      else {
        pen.moveTo(place(axes, width, index), heights[index]!(value));
        started = true;
      }
    });
  };
  const stroke = (runs: number[], colour: string, alpha: number): void => {
    pen.strokeStyle = colour;
    pen.globalAlpha = alpha;
    pen.lineWidth = 1;
    for (const run of runs) {
      pen.beginPath();
      add(run);
      pen.stroke();
    }
    pen.globalAlpha = 1;
  };
  const thin = Math.min(1, 14 / Math.sqrt(lines.length + 1));
  stroke(lines.filter((run) => overall[run] !== PASS), colours.muted, 0.3 * thin);
  stroke(lines.filter((run) => overall[run] === PASS), colours.pass, 0.7 * thin);
  const { selected } = store.state;
  if (selected >= 0 && store.study.done[selected]) {
    pen.lineJoin = "round";
    for (const [colour, thickness] of [[colours.plot, 5], [colours.ink, 2.4]] as const) {
      pen.beginPath();
      add(selected);
      pen.strokeStyle = colour;
      pen.lineWidth = thickness;
      pen.stroke();
    }
  }
  axes.forEach((axis, index) => drawAxis(pen, store, axis, place(axes, width, index), heights[index]!, (width - 2 * SIDE) / Math.max(1, axes.length - 1), colours));
}

function drawAxis(
  pen: CanvasRenderingContext2D,
  store: Store,
  axis: Axis,
  x: number,
  height: ScaleLinear<number, number>,
  room: number,
  colours: Palette,
): void {
  const [bottom, top] = height.range() as [number, number];
  pen.strokeStyle = colours.muted;
  pen.lineWidth = 1;
  pen.beginPath();
  pen.moveTo(Math.round(x) + 0.5, top);
  pen.lineTo(Math.round(x) + 0.5, bottom);
  pen.stroke();
  pen.textAlign = "center";
  pen.textBaseline = "alphabetic";
  pen.fillStyle = colours.ink;
  pen.font = `600 12px ${colours.font}`;
  pen.fillText(axis.title, x, top - 24, Math.min(room - 10, 2 * SIDE - 6));
  pen.fillStyle = colours.muted;
  pen.font = `11.5px ${colours.font}`;
  pen.fillText(number(axis.high, 3), x, top - 7);
  pen.fillText(number(axis.low, 3), x, bottom + 16);
  store.study.requirements.forEach(({ metric }, requirement) => {
    if (metric !== axis.metric || metric < 0) return;
    const { atMost, atLeast } = store.state.thresholds[requirement]!;
    for (const bound of [atMost, atLeast]) {
      if (bound === null) continue;
      const y = height(bound);
      pen.lineWidth = 7;
      pen.strokeStyle = colours.plot;
      segment(pen, x - 12, x + 12, y);
      pen.lineWidth = 4;
      pen.strokeStyle = colourOf(colours, requirement);
      segment(pen, x - 11, x + 11, y);
    }
  });
}

function segment(pen: CanvasRenderingContext2D, from: number, to: number, y: number): void {
  pen.beginPath();
  pen.moveTo(from, y);
  pen.lineTo(to, y);
  pen.stroke();
}

function nearest(canvas: HTMLCanvasElement, axes: Axis[], lines: number[], x: number, y: number): number {
  const heights = scales(axes, canvas.clientHeight);
  const step = (canvas.clientWidth - 2 * SIDE) / Math.max(1, axes.length - 1);
  const position = Math.min(axes.length - 1.001, Math.max(0, (x - SIDE) / step));
  const left = Math.floor(position);
  let best = -1;
  let least = 14;
  for (const run of lines) {
    const [a, b] = [left, Math.min(axes.length - 1, left + 1)].map((index) => heights[index]!(axes[index]!.values[run]!)) as [number, number];
    const away = Math.abs(a + (b - a) * (position - left) - y);
    if (away < least) {
      least = away;
      best = run;
    }
  }
  return best;
}
