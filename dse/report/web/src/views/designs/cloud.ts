// The points of the scatter on the canvas: designs or runs, over any two columns.
import { scaleLinear } from "d3-scale";
import { columnOf, type Keyed } from "../../columns";
import type { Grouping } from "../../grouping";
import { clipTo, type Frame } from "../../plot/frame";
import type { Pen } from "../../plot/pen";
import { drawShape, paintShape } from "../../plot/points";
import { createStamps, type Places, packed, sorted } from "../../plot/stamps";
import type { Study } from "../../study";
import type { Palette } from "../../theme";
import { FAIL, FAILED, NOT_EXERCISED, PASS } from "../../verdicts";
import type { Colouring } from "./colouring";
import type { Model } from "./model";

/** What is drawn: values on both axes, verdicts, and which lie within the brushes (null: all). */
export interface Cloud {
  x: Keyed;
  y: Keyed;
  marks: Uint8Array;
  within: Uint8Array | null;
  /** Which exercise every requirement: values of others do not stretch the axes. */
  exercised: Uint8Array;
  /** The run that stands for a point, and the point that a run belongs to. */
  run: (point: number) => number;
  point: (run: number) => number;
}

const ORDER = [FAILED, FAIL, NOT_EXERCISED, PASS];
const MOST_SHAPES = 6000;
const FADED = 0.13;
/** As many as there are marks. */
const OUTSIDE = 4;

export function cloudOf(model: Model): Cloud {
  const { store, choices, grouping } = model;
  if (choices.points === "runs") {
    const [x, y] = [columnOf(store.study, choices.x)!, columnOf(store.study, choices.y)!];
    return {
      x,
      y,
      marks: store.judgement().overall,
      within: store.within(),
      exercised: exercisedOf(store.study, null),
      run: (point) => point,
      point: (run) => run,
    };
  }
  const { mark, deciding } = model.standing();
  return {
    x: model.column(choices.x),
    y: model.column(choices.y),
    marks: mark,
    within: model.within(),
    exercised: exercisedOf(store.study, grouping),
    run: (point) => deciding[point] ?? -1,
    point: (run) => grouping.of[run] ?? -1,
  };
}

export function cloudFrame(width: number, height: number, { x, y, exercised }: Cloud): Frame {
  const counts = exercised.map((one, point) => (one && Number.isFinite(x.values[point]! + y.values[point]!) ? 1 : 0));
  const frame = { left: 66, right: width - 16, top: 14, bottom: height - 50 };
  return {
    ...frame,
    x: scaleLinear(limits(x.values, counts), [frame.left, frame.right]),
    y: scaleLinear(limits(y.values, counts), [frame.bottom, frame.top]),
  };
}

const known = new WeakMap<Study, Map<Grouping | null, Uint8Array>>();

/** Which designs, or without a *grouping* which runs, exercise every requirement. */
function exercisedOf(study: Study, grouping: Grouping | null): Uint8Array {
  const made = known.get(study) ?? new Map<Grouping | null, Uint8Array>();
  known.set(study, made);
  let found = made.get(grouping);
  if (!found) {
    const times = study.requirements.map(({ exercised }) => {
      const some = new Uint8Array(grouping?.size ?? study.size);
      for (let run = 0; run < study.size; run++) if (exercised[run]) some[grouping?.of[run] ?? run] = 1;
      return some;
    });
    found = new Uint8Array(grouping?.size ?? study.size).map((_, point) =>
      times.every((some) => some[point]) ? 1 : 0,
    );
    made.set(grouping, found);
  }
  return found;
}

/** The range of what is finite and *counts*, with some room; of all that is finite if nothing counts. */
function limits(values: Float64Array, counts: Uint8Array): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (let point = 0; point < values.length; point++) {
    const value = values[point]!;
    if (!counts[point] || !Number.isFinite(value)) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high)
    return counts.includes(1) || !values.some(Number.isFinite)
      ? [0, 1]
      : limits(values, new Uint8Array(values.length).fill(1));
  const room = 0.04 * (high - low) || Math.max(1e-9, 0.1 * Math.abs(low)) || 1;
  return [low - room, high + room];
}

/** Where the points lie in pixels, NaN for those that have no place on the axes. */
export function placesOf({ x, y }: Cloud, frame: Frame): Places {
  const line = (scale: Frame["x"], values: Float64Array): Float32Array => {
    const [low, high] = scale.domain() as [number, number];
    const [from, to] = [scale(low), scale(high)];
    const places = new Float32Array(values.length);
    for (let point = 0; point < places.length; point++) {
      const value = values[point]!;
      places[point] = value >= low && value <= high ? from + ((value - low) / (high - low)) * (to - from) : NaN;
    }
    return places;
  };
  return { a: line(frame.x, x.values), b: line(frame.y, y.values) };
}

export function paintCloud(
  pen: Pen,
  frame: Frame,
  cloud: Cloud,
  places: Places,
  colouring: Colouring,
  colours: Palette,
): void {
  pen.save();
  clipTo(pen, frame);
  if (cloud.marks.length > MOST_SHAPES) stamp(pen, cloud, places, colouring, colours);
  else shapes(pen, frame, cloud, places, colouring, colours);
  pen.restore();
}

function shapes(
  pen: Pen,
  frame: Frame,
  { marks, within }: Cloud,
  { a, b }: Places,
  { codes, colours: own }: Colouring,
  colours: Palette,
): void {
  const spacing = Math.sqrt(((frame.right - frame.left) * (frame.bottom - frame.top)) / Math.max(1, marks.length));
  const size = Math.min(1.25, Math.max(0.5, spacing / 18));
  for (const inside of [0, 1]) {
    pen.globalAlpha = inside ? 1 : FADED;
    for (const mark of ORDER) {
      for (let point = 0; point < marks.length; point++) {
        if (marks[point] !== mark || (within?.[point] ?? 1) !== inside || Number.isNaN(a[point]! + b[point]!)) continue;
        pen.beginPath();
        if (codes === null || mark === FAILED) {
          drawShape(pen, a[point]!, b[point]!, mark, size);
          paintShape(pen, mark, size, colours);
          continue;
        }
        // With colours that say something else, what is feasible is filled and the others are rings.
        pen.arc(a[point]!, b[point]!, mark === PASS ? 3.8 * size : 2.8 * size, 0, 2 * Math.PI);
        const colour = own[codes[point]!]!;
        pen.fillStyle = mark === PASS ? colour : colours.plot;
        pen.fill();
        pen.strokeStyle = mark === PASS ? colours.plot : colour;
        pen.lineWidth = mark === PASS ? 0.8 : 1.5 * size;
        pen.stroke();
      }
    }
  }
  pen.globalAlpha = 1;
}

function stamp(
  pen: Pen,
  { marks, within }: Cloud,
  places: Places,
  { codes, colours: own }: Colouring,
  colours: Palette,
): void {
  const stamps = createStamps(pen, marks.length);
  if (!stamps) return;
  const { ratio, side } = stamps;
  const byMark = [colours.pass, colours.ink, colours.muted, colours.broken].map(packed);
  const byCode = own.map(packed);
  const faint = packed(colours.line);
  const groups = sorted(
    within ? marks.map((mark, point) => (within[point] ? mark : OUTSIDE + mark)) : marks,
    2 * OUTSIDE,
  );
  for (const outside of [OUTSIDE, 0]) {
    for (const mark of ORDER) {
      const edge = mark === PASS ? side + Math.round(ratio) : side;
      const points = groups[outside + mark]!;
      if (outside) stamps.put(places, points, edge, [faint]);
      else stamps.put(places, points, edge, codes ? byCode : [byMark[mark]!], codes);
    }
  }
  stamps.draw();
}

/** The front: its points ringed, and if there are two aims and these are the axes, the edge of what it dominates. */
export function paintFront(
  pen: Pen,
  frame: Frame,
  model: Model,
  front: Uint8Array,
  { a, b }: Places,
  colours: Palette,
): void {
  const { choices } = model;
  const on: number[] = [];
  for (let point = 0; point < front.length; point++)
    if (front[point] && !Number.isNaN(a[point]! + b[point]!)) on.push(point);
  pen.save();
  clipTo(pen, frame);
  const across = choices.criteria.find(({ column }) => column === choices.x);
  const up = choices.criteria.find(({ column }) => column === choices.y);
  pen.strokeStyle = colours.current;
  if (across && up && across !== up && choices.criteria.length === 2 && on.length) {
    const points = on.map((point) => [a[point]!, b[point]!] as const).sort((p, q) => p[0] - q[0] || p[1] - q[1]);
    // Worse is right of the front, or left of it; above it, or below.
    const [right, above] = [across.maximize ? frame.left : frame.right, up.maximize ? frame.bottom : frame.top];
    const path = across.maximize ? points.reverse() : points;
    pen.beginPath();
    pen.moveTo(path[0]![0], above);
    pen.lineTo(...path[0]!);
    for (let i = 1; i < path.length; i++) {
      pen.lineTo(path[i]![0], path[i - 1]![1]);
      pen.lineTo(...path[i]!);
    }
    pen.lineTo(right, path.at(-1)![1]);
    pen.lineWidth = 1.6;
    pen.stroke();
  }
  pen.beginPath();
  for (const point of on) {
    pen.moveTo(a[point]! + 6, b[point]!);
    pen.arc(a[point]!, b[point]!, 6, 0, 2 * Math.PI);
  }
  pen.lineWidth = 1.6;
  pen.stroke();
  pen.restore();
}
