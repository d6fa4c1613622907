// Where the plot lies on the canvas and how data become pixels.
import { scaleLinear, type ScaleLinear } from "d3-scale";
import { axisLabel, type Variable } from "../study";
import { number } from "../format";
import type { Palette } from "../theme";

export interface Frame {
  left: number;
  right: number;
  top: number;
  bottom: number;
  x: ScaleLinear<number, number>;
  y: ScaleLinear<number, number>;
}

export function frameOf(width: number, height: number, horizontal: Variable, vertical: Variable, bar: boolean): Frame {
  const frame = { left: 66, right: width - (bar ? 96 : 16), top: 14, bottom: height - 50 };
  return {
    ...frame,
    x: scaleLinear([horizontal.low, horizontal.high], [frame.left, frame.right]),
    y: scaleLinear([vertical.low, vertical.high], [frame.bottom, frame.top]),
  };
}

export function clipTo(pen: CanvasRenderingContext2D, { left, right, top, bottom }: Frame): void {
  pen.beginPath();
  pen.rect(left, top, right - left, bottom - top);
  pen.clip();
}

export function drawAxes(
  pen: CanvasRenderingContext2D,
  frame: Frame,
  horizontal: Variable,
  vertical: Variable,
  colours: Palette,
): void {
  const { left, right, top, bottom, x, y } = frame;
  pen.strokeStyle = colours.muted;
  pen.fillStyle = colours.ink;
  pen.lineWidth = 1;
  pen.font = `12px ${colours.font}`;
  pen.strokeRect(Math.round(left) + 0.5, Math.round(top) + 0.5, Math.round(right - left) - 1, Math.round(bottom - top) - 1);
  pen.beginPath();
  pen.textAlign = "center";
  pen.textBaseline = "alphabetic";
  for (const tick of x.ticks(Math.max(3, (right - left) / 80))) {
    const place = Math.round(x(tick)) + 0.5;
    pen.moveTo(place, bottom);
    pen.lineTo(place, bottom + 5);
    pen.fillText(number(tick, 6), place, bottom + 19);
  }
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const tick of y.ticks(Math.max(3, (bottom - top) / 60))) {
    const place = Math.round(y(tick)) - 0.5;
    pen.moveTo(left - 5, place);
    pen.lineTo(left, place);
    pen.fillText(number(tick, 6), left - 9, place + 0.5);
  }
  pen.stroke();
  pen.font = `600 12.5px ${colours.font}`;
  pen.textAlign = "center";
  pen.textBaseline = "alphabetic";
  pen.fillText(axisLabel(horizontal), (left + right) / 2, bottom + 42, right - left);
  sideways(pen, 16, (top + bottom) / 2, () => pen.fillText(axisLabel(vertical), 0, 0, bottom - top));
}

export function sideways(pen: CanvasRenderingContext2D, x: number, y: number, draw: () => void): void {
  pen.save();
  pen.translate(x, y);
  pen.rotate(-Math.PI / 2);
  draw();
  pen.restore();
}
