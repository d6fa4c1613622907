// The runs as points: filled = pass, dot = fail, hollow = not exercised, cross = failed to run.
import type { Plane } from "../plane/plane";
import type { Study } from "../study";
import type { Palette } from "../theme";
import { FAIL, FAILED, type Judgement, NOT_EXERCISED, PASS } from "../verdicts";
import { clipTo, type Frame } from "./frame";
import type { Pen } from "./pen";
import { createStamps, packed, sorted } from "./stamps";

const MOST_DRAWN = 6000;
const ORDER = [FAIL, NOT_EXERCISED, PASS, FAILED];
const SHADES = 6;
const OUTSIDE = 4;
const SET_BACK = 0.35;
const EDGE = 9;

/** Draws the runs of the plane; those that lie not *within* the brushes (null: there are none) are set back. */
export function paintPoints(
  pen: Pen,
  frame: Frame,
  study: Study,
  plane: Plane,
  { overall: marks, doubtful }: Judgement,
  within: Uint8Array | null,
  colours: Palette,
): void {
  const total = plane.on.length + plane.beside.length;
  pen.save();
  clipTo(pen, rimmed(frame, study, plane));
  if (total > MOST_DRAWN) {
    stampPoints(pen, frame, study, plane, marks, within, colours);
    paintRings(pen, frame, study, plane, doubtful, 0.4, colours);
    return pen.restore();
  }
  const spacing = Math.sqrt(((frame.right - frame.left) * (frame.bottom - frame.top)) / Math.max(1, total));
  const size = Math.min(1, Math.max(0.4, spacing / 22));
  const isIn = (run: number): boolean => !within || within[run] === 1;
  const paint = (runs: number[]): void => {
    for (const mark of ORDER)
      drawMark(
        pen,
        frame,
        study,
        plane,
        runs.filter((run) => marks[run] === mark),
        mark,
        size,
        colours,
      );
  };
  pen.globalAlpha = SET_BACK;
  drawMark(
    pen,
    frame,
    study,
    plane,
    [...plane.beside, ...plane.on].filter((run) => !isIn(run)),
    FAIL,
    size,
    { ...colours, ink: colours.muted },
  );
  const groups: number[][] = Array.from({ length: SHADES }, () => []);
  plane.beside.forEach((run, i) => {
    if (isIn(run)) groups[Math.min(SHADES - 1, Math.floor(plane.strength[i]! * SHADES))]!.push(run);
  });
  groups.forEach((runs, shade) => {
    pen.globalAlpha = (shade + 1) / SHADES;
    paint(runs);
  });
  pen.globalAlpha = 1;
  paint(Array.from(plane.on).filter(isIn));
  paintRings(pen, frame, study, plane, doubtful, size, colours);
  pen.restore();
}

// Points on the rim of the plane are whole; what lies beyond a part that was zoomed to is not drawn over the axes.
function rimmed(frame: Frame, study: Study, { x, y }: Plane): Frame {
  const edge = (scale: Frame["x"], index: number, end: 0 | 1): number => {
    const { low, high } = study.variables[index]!;
    return Math.abs(scale.domain()[end]! - (end ? high : low)) < 1e-9 * (high - low) ? EDGE : 0;
  };
  return {
    ...frame,
    left: frame.left - edge(frame.x, x, 0),
    right: frame.right + edge(frame.x, x, 1),
    top: frame.top - edge(frame.y, y, 1),
    bottom: frame.bottom + edge(frame.y, y, 0),
  };
}

/** A ring around runs with a verdict that finer numerics may change. */
function paintRings(
  pen: Pen,
  frame: Frame,
  study: Study,
  plane: Plane,
  doubtful: Uint8Array,
  size: number,
  colours: Palette,
): void {
  const radius = 6 * Math.max(0.7, size);
  pen.beginPath();
  for (const run of plane.on) {
    if (!doubtful[run]) continue;
    const [x, y] = placeOf(frame, study, plane, run);
    pen.moveTo(x + radius, y);
    pen.arc(x, y, radius, 0, 2 * Math.PI);
  }
  pen.strokeStyle = colours.plot;
  pen.lineWidth = 3.2;
  pen.stroke();
  pen.strokeStyle = colours.ink;
  pen.lineWidth = 1.4;
  pen.stroke();
}

function drawMark(
  pen: Pen,
  frame: Frame,
  study: Study,
  plane: Plane,
  runs: number[],
  mark: number,
  size: number,
  colours: Palette,
): void {
  if (!runs.length) return;
  const places = runs.map((run) => placeOf(frame, study, plane, run));
  pen.beginPath();
  for (const [x, y] of places) drawShape(pen, x, y, mark, size);
  paintShape(pen, mark, size, colours);
}

/** Adds one mark's outline to the current path. */
export function drawShape(pen: Pen, x: number, y: number, mark: number, size: number): void {
  if (mark === FAILED) {
    const arm = 4.2 * Math.max(0.7, size);
    pen.moveTo(x - arm, y - arm);
    pen.lineTo(x + arm, y + arm);
    pen.moveTo(x - arm, y + arm);
    pen.lineTo(x + arm, y - arm);
    return;
  }
  const radius = mark === PASS ? 3.6 * size : mark === FAIL ? Math.max(0.9, 1.6 * size) : 2.9 * size;
  pen.moveTo(x + radius, y);
  pen.arc(x, y, radius, 0, 2 * Math.PI);
}

/** Paints the marks of the current path. */
export function paintShape(pen: Pen, mark: number, size: number, colours: Palette): void {
  if (mark === FAILED) {
    pen.strokeStyle = colours.plot;
    pen.lineWidth = 4.5;
    pen.stroke();
    pen.strokeStyle = colours.broken;
    pen.lineWidth = 2;
  } else if (mark === PASS) {
    pen.fillStyle = colours.pass;
    pen.fill();
    pen.strokeStyle = colours.plot;
    pen.lineWidth = 1.2 * size;
  } else if (mark === FAIL) {
    pen.fillStyle = colours.ink;
    pen.fill();
    return;
  } else {
    pen.fillStyle = colours.plot;
    pen.fill();
    pen.strokeStyle = colours.muted;
    pen.lineWidth = Math.max(0.8, 1.2 * size);
  }
  pen.stroke();
}

export function placeOf(frame: Frame, study: Study, { x, y }: Plane, run: number): [number, number] {
  return [frame.x(study.variables[x]!.values[run]!), frame.y(study.variables[y]!.values[run]!)];
}

function stampPoints(
  pen: Pen,
  frame: Frame,
  study: Study,
  plane: Plane,
  marks: Uint8Array,
  within: Uint8Array | null,
  colours: Palette,
): void {
  const runs = plane.beside.length ? joined(plane.on, plane.beside) : plane.on;
  const stamps = createStamps(pen, runs.length);
  if (!stamps) return;
  const { ratio, side } = stamps;
  // The last is for what lies outside of the brushes, and is drawn first.
  const ink = [colours.pass, colours.ink, colours.muted, colours.broken, colours.line].map(packed);
  const sides = [side + Math.round(ratio), side, side, side + Math.round(2 * ratio), side];
  const xs = study.variables[plane.x]!.values;
  const ys = study.variables[plane.y]!.values;
  const [x0, x1] = [frame.x(0), frame.x(1) - frame.x(0)];
  const [y0, y1] = [frame.y(0), frame.y(1) - frame.y(0)];
  const places = {
    a: Float32Array.from(runs, (run) => x0 + x1 * xs[run]!),
    b: Float32Array.from(runs, (run) => y0 + y1 * ys[run]!),
  };
  const groups = sorted(
    Uint8Array.from(runs, (run) => (within && !within[run] ? OUTSIDE : marks[run]!)),
    OUTSIDE + 1,
  );
  for (const mark of [OUTSIDE, ...ORDER]) stamps.put(places, groups[mark]!, sides[mark]!, [ink[mark]!]);
  stamps.draw();
}

function joined(a: Int32Array, b: Int32Array): Int32Array {
  const both = new Int32Array(a.length + b.length);
  both.set(a);
  both.set(b, a.length);
  return both;
}
