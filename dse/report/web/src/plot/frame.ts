// Where the plot lies on the canvas and how data become pixels.
import { type ScaleContinuousNumeric, scaleLinear, scaleLog } from "d3-scale";
import { number } from "../format";
import type { Zoom } from "../store";
import { axisLabel } from "../study";
import type { Palette } from "../theme";
import type { Pen } from "./pen";

export type Scale = ScaleContinuousNumeric<number, number>;

/** What an axis says; `names` stand at 0, 1, … in place of numbers. */
export interface AxisText {
  title: string;
  unit: string;
  log?: boolean;
  names?: string[];
  /** Values that are evenly spaced, and the only ones that have a tick. */
  apart?: number[];
}

export interface Frame {
  left: number;
  right: number;
  top: number;
  bottom: number;
  x: Scale;
  y: Scale;
}

/** What every frame has beside the axes at least. */
const LEFT = 60;
const RIGHT = 14;

/** A frame that leaves room for the axes' texts, and for the colour *bar* if there is one. */
export function frameOf(
  width: number,
  height: number,
  { x, y }: Zoom,
  bar: boolean,
  axes: { x: Spacing; y: Spacing } = { x: {}, y: {} },
): Frame {
  const frame = { left: 66, right: width - (bar ? 96 : 16), top: 14, bottom: height - 50 };
  return {
    ...frame,
    x: spaced(x, axes.x, frame.left, frame.right),
    y: spaced(y, axes.y, frame.bottom, frame.top),
  };
}

/** How values are spaced on an axis: evenly by default. */
export type Spacing = Pick<AxisText, "apart" | "log">;

/** From values to pixels; each step from one of *apart* to the next is as wide as any other. */
export function spaced(
  [low, high]: readonly [number, number],
  { apart = [], log = false }: Spacing,
  from: number,
  to: number,
): Scale {
  if (log && low > 0 && apart.length < 2) return scaleLog([low, high], [from, to]);
  if (apart.length < 2) return scaleLinear([low, high], [from, to]);
  const step = scaleLinear(
    apart,
    apart.map((_, index) => index),
  );
  // Half a step is left on either side of the first and the last.
  const [first, last] = [apart[0]!, apart.at(-1)!];
  const [least, most] = [step(low) - Number(low <= first) / 2, step(high) + Number(high >= last) / 2];
  const stops = [low, ...apart.filter((value) => value > low && value < high), high];
  return scaleLinear(
    stops,
    stops.map((value) => from + ((to - from) * (step(value) - least)) / (most - least)),
  );
}

export function clipTo(pen: Pen, { left, right, top, bottom }: Frame): void {
  pen.beginPath();
  pen.rect(left, top, right - left, bottom - top);
  pen.clip();
}

export function drawAxes(pen: Pen, frame: Frame, horizontal: AxisText, vertical: AxisText, colours: Palette): void {
  const { left, right, top, bottom, x, y } = frame;
  pen.strokeStyle = colours.muted;
  pen.fillStyle = colours.ink;
  pen.lineWidth = 1;
  pen.font = `12px ${colours.font}`;
  pen.strokeRect(
    Math.round(left) + 0.5,
    Math.round(top) + 0.5,
    Math.round(right - left) - 1,
    Math.round(bottom - top) - 1,
  );
  pen.beginPath();
  pen.textAlign = "center";
  pen.textBaseline = "alphabetic";
  const across = ticksOf(x, horizontal, (right - left) / 80);
  const room = (right - left) / across.length - 4;
  // Names that are wider than their place stand in two rows: every category has its label.
  const rows = horizontal.names?.length && across.some(([, text]) => pen.measureText(text).width > room) ? 2 : 1;
  for (const [index, [tick, text]] of across.entries()) {
    const place = Math.round(x(tick)) + 0.5;
    const row = index % rows;
    pen.moveTo(place, bottom);
    pen.lineTo(place, bottom + 5);
    const shown = fitted(pen, text, rows * room);
    // At the ends a text stands a little inwards, lest the picture's edge cuts it.
    const half = pen.measureText(shown).width / 2;
    pen.fillText(shown, Math.max(left - LEFT + half, Math.min(right + RIGHT - half, place)), bottom + 17 + 12 * row);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [tick, text] of ticksOf(y, vertical, (bottom - top) / 60)) {
    const place = Math.round(y(tick)) - 0.5;
    pen.moveTo(left - 5, place);
    pen.lineTo(left, place);
    pen.fillText(text, left - 9, place + 0.5, left - 34);
  }
  pen.stroke();
  pen.font = `600 12.5px ${colours.font}`;
  pen.textAlign = "center";
  pen.textBaseline = "alphabetic";
  pen.fillText(fitted(pen, axisText(horizontal), right - left), (left + right) / 2, bottom + 42);
  sideways(pen, 16, (top + bottom) / 2, () => pen.fillText(fitted(pen, axisText(vertical), bottom - top), 0, 0));
}

export function drawGrid(pen: Pen, frame: Frame, horizontal: AxisText, vertical: AxisText, colours: Palette): void {
  const { left, right, top, bottom, x, y } = frame;
  pen.strokeStyle = colours.line;
  pen.lineWidth = 1;
  pen.beginPath();
  for (const [tick] of ticksOf(x, horizontal, (right - left) / 80)) {
    pen.moveTo(Math.round(x(tick)) + 0.5, top);
    pen.lineTo(Math.round(x(tick)) + 0.5, bottom);
  }
  for (const [tick] of ticksOf(y, vertical, (bottom - top) / 60)) {
    pen.moveTo(left, Math.round(y(tick)) - 0.5);
    pen.lineTo(right, Math.round(y(tick)) - 0.5);
  }
  pen.stroke();
}

export function axisText(axis: AxisText): string {
  return axis.names?.length ? axis.title : axisLabel(axis);
}

/** *text*, with an ellipsis where it would be wider than *room*: in its middle, as names differ at their ends. */
export function fitted(pen: Pen, text: string, room: number): string {
  if (pen.measureText(text).width <= room) return text;
  const cut = (kept: number): string =>
    `${text.slice(0, Math.ceil(kept / 2))}\u2026${text.slice(text.length - Math.floor(kept / 2))}`;
  let [fits, many] = [0, text.length];
  while (many - fits > 1) {
    const half = (fits + many) >> 1;
    if (pen.measureText(cut(half)).width <= room) fits = half;
    else many = half;
  }
  return cut(fits);
}

function ticksOf(scale: Scale, { log, names, apart }: AxisText, count: number): [number, string][] {
  if (apart?.length) {
    const [low, high] = [scale.domain()[0]!, scale.domain().at(-1)!];
    return apart.filter((value) => value >= low && value <= high).map((value) => [value, number(value, 6)]);
  }
  if (names?.length) {
    // Of more names than there is room for some go without a label.
    const stride = Math.ceil(names.length / Math.max(8, 4 * count));
    return names
      .map((name, index): [number, string] => [index, name])
      .filter(([, name], index) => name && index % stride === 0);
  }
  const ticks = scale.ticks(Math.max(3, count));
  const decades = ticks.filter((tick) => Number.isInteger(Math.log10(tick)));
  // Over many decades a logarithmic scale offers every digit of each.
  return (log && decades.length > 2 ? decades : ticks).map((tick) => [tick, number(tick, 6)]);
}

export function sideways(pen: Pen, x: number, y: number, draw: () => void): void {
  pen.save();
  pen.translate(x, y);
  pen.rotate(-Math.PI / 2);
  draw();
  pen.restore();
}
