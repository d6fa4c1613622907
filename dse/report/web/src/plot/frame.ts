// Where the plot lies on the canvas and how data become pixels.
import { type ScaleContinuousNumeric, scaleLinear } from "d3-scale";
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
export function frameOf(width: number, height: number, { x, y }: Zoom, bar: boolean): Frame {
  const frame = { left: 66, right: width - (bar ? 96 : 16), top: 14, bottom: height - 50 };
  return { ...frame, x: scaleLinear(x, [frame.left, frame.right]), y: scaleLinear(y, [frame.bottom, frame.top]) };
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
  for (const [tick, text] of across) {
    const place = Math.round(x(tick)) + 0.5;
    pen.moveTo(place, bottom);
    pen.lineTo(place, bottom + 5);
    const shown = fitted(pen, text, (right - left) / across.length - 4);
    // At the ends a text stands a little inwards, lest the picture's edge cuts it.
    const half = pen.measureText(shown).width / 2;
    pen.fillText(shown, Math.max(left - LEFT + half, Math.min(right + RIGHT - half, place)), bottom + 19);
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

/** *text*, with an ellipsis where it would be wider than *room*. */
export function fitted(pen: Pen, text: string, room: number): string {
  if (pen.measureText(text).width <= room) return text;
  let [fits, many] = [0, text.length];
  while (many - fits > 1) {
    const half = (fits + many) >> 1;
    if (pen.measureText(`${text.slice(0, half)}\u2026`).width <= room) fits = half;
    else many = half;
  }
  return `${text.slice(0, fits)}\u2026`;
}

function ticksOf(scale: Scale, { log, names }: AxisText, count: number): [number, string][] {
  if (names?.length) {
    const stride = Math.ceil(names.length / Math.max(3, count));
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
