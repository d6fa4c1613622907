// A legend as a part of a picture that is saved; on the page legends are text.
import { type Palette, palette } from "../theme";
import type { Mark } from "../verdicts";
import type { Pen } from "./pen";
import { drawShape, paintShape } from "./points";

export interface Entry {
  text: string;
  /** Draws the sign around a place, no more than SIGN wide and high. */
  draw: (pen: Pen, x: number, y: number) => void;
}

export const SIGN = 16;
const LINE = 22;
const EDGE = 12;
const MOST = 90;

export function markEntry(mark: Mark, text: string): Entry {
  return {
    text,
    draw(pen, x, y) {
      pen.beginPath();
      drawShape(pen, x, y, mark, 1);
      paintShape(pen, mark, 1, palette());
    },
  };
}

export function lineEntry(text: string, colour: string, dash: number[] = []): Entry {
  return {
    text,
    draw(pen, x, y) {
      pen.strokeStyle = colour;
      pen.lineWidth = 2;
      pen.setLineDash(dash);
      pen.beginPath();
      pen.moveTo(x - SIGN / 2, y);
      pen.lineTo(x + SIGN / 2, y);
      pen.stroke();
    },
  };
}

export function dotEntry(text: string, colour: string): Entry {
  return {
    text,
    draw(pen, x, y) {
      pen.fillStyle = colour;
      pen.beginPath();
      pen.arc(x, y, 5, 0, 2 * Math.PI);
      pen.fill();
    },
  };
}

/** Paints the entries in as many lines as they need; the height that takes. */
export function paintLegend(pen: Pen, entries: readonly Entry[], width: number, colours: Palette): number {
  if (!entries.length) return 0;
  let [x, line] = [EDGE, 0];
  pen.save();
  for (const entry of entries) {
    const text = entry.text.length > MOST ? `${entry.text.slice(0, MOST - 1)}\u2026` : entry.text;
    pen.font = `12px ${colours.font}`;
    const room = SIGN + 6 + pen.measureText(text).width + 18;
    if (x > EDGE && x + room > width) [x, line] = [EDGE, line + 1];
    const y = line * LINE + LINE / 2;
    pen.save();
    entry.draw(pen, x + SIGN / 2, y);
    pen.restore();
    pen.fillStyle = colours.ink;
    pen.textAlign = "left";
    pen.textBaseline = "middle";
    pen.fillText(text, x + SIGN + 6, y, Math.max(20, width - x - SIGN - 6));
    x += room;
  }
  pen.restore();
  return (line + 1) * LINE + 8;
}
