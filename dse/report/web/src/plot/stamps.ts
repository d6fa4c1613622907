// Beyond some thousand points a path per point is slow; squares set straight into pixels take milliseconds.
import { channels } from "../theme";
import type { Pen } from "./pen";

export interface Stamps {
  /** Device pixels of a CSS pixel. */
  ratio: number;
  /** The side of a square, in device pixels, for as many points as there are. */
  side: number;
  /** A square of *edge* device pixels around a place in CSS pixels; one that is not whole on the canvas is left out. */
  put(x: number, y: number, edge: number, colour: number): void;
  /** Brings all squares onto the canvas. */
  draw(): void;
}

/** For *count* points; null where the canvas has no size, as its view is not shown. */
export function createStamps(pen: Pen, count: number): Stamps | null {
  const ratio = pen.getTransform().a;
  const { width, height } = pen.canvas;
  if (!width || !height) return null;
  const image = new ImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  return {
    ratio,
    side: Math.max(1, Math.round((count > 200_000 ? 1 : count > 40_000 ? 1.5 : 2.4) * ratio)),
    put(x, y, edge, colour) {
      const column = Math.round(x * ratio - edge / 2);
      const row = Math.round(y * ratio - edge / 2);
      // A place that is no number is nowhere.
      if (!(column >= 0 && row >= 0 && column + edge <= width && row + edge <= height)) return;
      for (let down = 0; down < edge; down++) {
        const start = (row + down) * width + column;
        for (let right = 0; right < edge; right++) pixels[start + right] = colour;
      }
    },
    draw() {
      const sheet = document.createElement("canvas");
      sheet.width = width;
      sheet.height = height;
      sheet.getContext("2d")!.putImageData(image, 0, 0);
      pen.drawImage(sheet, 0, 0, width / ratio, height / ratio);
    },
  };
}

/** A colour, as `#rrggbb` or `rgb(r,g,b)`, as the four bytes of a pixel. */
export function packed(colour: string): number {
  const [red, green, blue] = colour.startsWith("#") ? channels(colour) : (colour.match(/\d+/g)!.map(Number) as [number, number, number]);
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}
