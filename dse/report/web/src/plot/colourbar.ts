// The scale of the metric shown as colour: one block per band, as in the plot.
import { number } from "../format";
import { axisLabel, type Column } from "../study";
import type { Palette } from "../theme";
import { type Frame, sideways } from "./frame";
import type { Pen } from "./pen";
import { bandColour, type Scale } from "./regions";

const WIDTH = 14;

export function drawColourBar(
  pen: Pen,
  frame: Frame,
  width: number,
  metric: Column,
  { steps }: Scale,
  colours: Palette,
): void {
  const left = frame.right + 16;
  const height = (frame.bottom - frame.top) / steps.length;
  steps.forEach((_, index) => {
    pen.fillStyle = bandColour(colours, index, steps.length);
    pen.fillRect(left, frame.bottom - (index + 1) * height, WIDTH, height + 0.5);
  });
  pen.strokeStyle = colours.muted;
  pen.lineWidth = 1;
  pen.strokeRect(left + 0.5, frame.top + 0.5, WIDTH - 1, frame.bottom - frame.top - 1);
  pen.fillStyle = colours.ink;
  pen.font = `11.5px ${colours.font}`;
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  // Each label stands at the lower edge of its band; the first band also holds what is below, the last what is above.
  steps.slice(1).forEach((step, index) => {
    pen.fillText(number(step, 5), left + WIDTH + 5, frame.bottom - (index + 1) * height);
  });
  pen.font = `600 12px ${colours.font}`;
  pen.textAlign = "center";
  pen.textBaseline = "alphabetic";
  sideways(pen, width - 5, (frame.top + frame.bottom) / 2, () =>
    pen.fillText(axisLabel(metric), 0, 0, frame.bottom - frame.top),
  );
}
