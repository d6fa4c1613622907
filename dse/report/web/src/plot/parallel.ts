// Axes beside each other, and runs as lines across them.
import { columnOf, columnsOf, type Keyed } from "../columns";
import { number } from "../format";
import type { Store } from "../store";
import { axisLabel, type Study } from "../study";
import { type Palette, palette } from "../theme";
import { PASS } from "../verdicts";
import { fitted, type Scale, spaced } from "./frame";
import type { Pen } from "./pen";
import { colourOf } from "./regions";
import type { Sheet } from "./sheet";

export const TOP = 22;
export const FOOT = 22;
export const SIDE = 62;
const REACH = 12;

export interface Axis {
  key: string;
  title: string;
  values: Float64Array;
  /** Of the axis: the bulk of the values, so that one wild run does not flatten the others. */
  low: number;
  high: number;
  /** Of all values. */
  least: number;
  most: number;
  /** Values that are evenly spaced, each with its text: names, and those between which nothing is known. */
  apart: number[];
  texts: string[];
}

const known = new WeakMap<Study, Map<string, Axis>>();

export function axesOf(study: Study): Axis[] {
  return columnsOf(study).map(({ key }) => axisOf(study, key));
}

/** The axis of the column with *key*, which the study must have. */
export function axisOf(study: Study, key: string): Axis {
  const axes = known.get(study) ?? new Map<string, Axis>();
  known.set(study, axes);
  const axis = axes.get(key) ?? axisFor(study, columnOf(study, key)!);
  axes.set(key, axis);
  return axis;
}

function axisFor(study: Study, column: Keyed): Axis {
  const sorted = column.values.filter((value, run) => Number.isFinite(value) && study.done[run] === 1).sort();
  const at = (part: number): number => sorted[Math.round(part * (sorted.length - 1))] ?? 0;
  const variable = column.key.startsWith("variable.") ? study.variables[Number(column.key.slice(9))] : undefined;
  const apart = variable?.labels.length ? variable.labels.map((_, index) => index) : (variable?.apart ?? []);
  const [low, high] = variable ? [variable.low, variable.high] : [at(0.01), at(0.99)];
  return {
    key: column.key,
    title: axisLabel(column),
    values: column.values,
    low,
    high: high > low ? high : low + 1,
    least: Math.min(at(0), low),
    most: Math.max(at(1), high),
    apart,
    texts: apart.map((value) => (variable?.labels.length ? variable.labels[value]! : number(value, 6))),
  };
}

export function heightsOf(axes: Axis[], height: number): Scale[] {
  return axes.map(({ low, high, apart }) => spaced([low, high], { apart }, height - FOOT, TOP).clamp(true));
}

export function placeOf(axes: number, width: number, index: number): number {
  return axes < 2 ? width / 2 : SIDE + (index * (width - 2 * SIDE)) / (axes - 1);
}

/** Lines *inside* of the brushes in the colours of their verdicts, those *outside* set back behind them. */
export function paintLines(
  { pen, width, height }: Sheet,
  store: Store,
  axes: Axis[],
  { inside, outside }: { inside: number[]; outside: number[] },
): void {
  const colours = palette();
  const { study, state } = store;
  const { overall } = store.judgement();
  const xs = axes.map((_, index) => placeOf(axes.length, width, index));
  // The scales are linear; asking them for every value would take most of the time.
  const scales = heightsOf(axes, height);
  const slopes = axes.map(({ low, high }) => (height - FOOT - TOP) / (high - low));
  const add = (run: number): void => {
    let started = false;
    for (let index = 0; index < axes.length; index++) {
      const { values, low, apart } = axes[index]!;
      const value = values[run]!;
      if (!Number.isFinite(value)) started = false;
      else {
        const y = apart.length
          ? scales[index]!(value)
          : Math.min(height - FOOT, Math.max(TOP, height - FOOT - (value - low) * slopes[index]!));
        if (started) pen.lineTo(xs[index]!, y);
        else pen.moveTo(xs[index]!, y);
        started = true;
      }
    }
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
  const thin = Math.min(1, 14 / Math.sqrt(inside.length + 1));
  stroke(outside, colours.line, 0.5);
  stroke(
    inside.filter((run) => overall[run] !== PASS),
    colours.muted,
    Math.max(0.12, 0.4 * thin),
  );
  stroke(
    inside.filter((run) => overall[run] === PASS),
    colours.pass,
    Math.max(0.2, 0.7 * thin),
  );
  const emphasise = (run: number, colour: string, thickness: number): void => {
    if (run < 0 || !study.done[run]) return;
    pen.lineJoin = "round";
    for (const [ink, wide] of [
      [colours.plot, thickness + 2.6],
      [colour, thickness],
    ] as const) {
      pen.beginPath();
      add(run);
      pen.strokeStyle = ink;
      pen.lineWidth = wide;
      pen.stroke();
    }
  };
  state.pins.forEach((pin, index) => emphasise(pin, colours.pins[index]!, 2));
  if (state.hovered !== state.selected) emphasise(state.hovered, colours.current, 1.4);
  emphasise(state.selected, colours.ink, 2.4);
  axes.forEach((axis, index) => drawAxis(pen, store, axis, xs[index]!, height, colours));
}

function drawAxis(pen: Pen, { study, state }: Store, axis: Axis, x: number, height: number, colours: Palette): void {
  const scale = heightsOf([axis], height)[0]!;
  pen.strokeStyle = colours.muted;
  pen.lineWidth = 1;
  segment(pen, Math.round(x) + 0.5, TOP, Math.round(x) + 0.5, height - FOOT);
  pen.textAlign = "center";
  pen.textBaseline = "alphabetic";
  pen.fillStyle = colours.muted;
  pen.font = `11.5px ${colours.font}`;
  if (axis.apart.length) writeTexts(pen, axis, scale, x, colours);
  else {
    pen.fillText(number(axis.high, 3), x, TOP - 7);
    pen.fillText(number(axis.low, 3), x, height - FOOT + 16);
  }
  const brush = state.brushes.find(({ column }) => column === axis.key);
  if (brush) {
    const [from, to] = [scale(brush.high), scale(brush.low)];
    pen.fillStyle = colours.accent;
    pen.globalAlpha = 0.3;
    pen.fillRect(x - 8, from, 16, Math.max(2, to - from));
    pen.globalAlpha = 1;
    pen.strokeStyle = colours.accent;
    pen.lineWidth = 1.5;
    pen.strokeRect(x - 8, from, 16, Math.max(2, to - from));
  }
  study.requirements.forEach(({ metric }, requirement) => {
    const { atMost, atLeast, off } = state.thresholds[requirement]!;
    if (`metric.${metric}` !== axis.key || off) return;
    for (const bound of [atMost, atLeast]) {
      if (bound === null) continue;
      pen.lineWidth = 7;
      pen.strokeStyle = colours.plot;
      segment(pen, x - 12, scale(bound), x + 12, scale(bound));
      pen.lineWidth = 4;
      pen.strokeStyle = colourOf(colours, requirement);
      segment(pen, x - 11, scale(bound), x + 11, scale(bound));
    }
  });
}

function writeTexts(pen: Pen, { apart, texts }: Axis, scale: Scale, x: number, colours: Palette): void {
  pen.lineWidth = 3;
  pen.strokeStyle = colours.plot;
  pen.textAlign = "left";
  apart.forEach((value, index) => {
    const shown = fitted(pen, texts[index]!, 2 * SIDE - 34);
    pen.strokeText(shown, x + 5, scale(value) - 4);
    pen.fillText(shown, x + 5, scale(value) - 4);
  });
  pen.textAlign = "center";
}

function segment(pen: Pen, x0: number, y0: number, x1: number, y1: number): void {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

/** The line under a place of the canvas, -1 if there is none. */
export function nearestLine(canvas: HTMLCanvasElement, axes: Axis[], lines: number[], x: number, y: number): number {
  if (axes.length < 2) return -1;
  const heights = heightsOf(axes, canvas.clientHeight);
  const step = (canvas.clientWidth - 2 * SIDE) / (axes.length - 1);
  const position = Math.min(axes.length - 1.001, Math.max(0, (x - SIDE) / step));
  const left = Math.floor(position);
  let best = -1;
  let least = REACH;
  for (const run of lines) {
    const a = heights[left]!(axes[left]!.values[run]!);
    const b = heights[left + 1]!(axes[left + 1]!.values[run]!);
    const away = Math.abs(a + (b - a) * (position - left) - y);
    if (away < least) {
      least = away;
      best = run;
    }
  }
  return best;
}
