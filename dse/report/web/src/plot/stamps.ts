// Beyond some thousand points a path per point is slow; squares set straight into pixels take milliseconds.
import { channels } from "../theme";
import type { Pen } from "./pen";

/** Where points lie, in CSS pixels. */
export interface Places {
  a: Float32Array;
  b: Float32Array;
}

export interface Stamps {
  /** Device pixels of a CSS pixel. */
  ratio: number;
  /** The side of a square, in device pixels, for as many points as there are. */
  side: number;
  /** Squares of *edge* device pixels around places in CSS pixels, x and y, of the *points*; one that is not whole on the
   * canvas is left out. A point has its colour by its code, without codes the first one. */
  put(places: Places, points: Int32Array, edge: number, colours: ArrayLike<number>, codes?: Uint8Array | null): void;
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
    put({ a, b }, points, edge, colours, codes = null) {
      const half = edge / 2;
      const [right, bottom] = [width - edge, height - edge];
      for (let i = 0; i < points.length; i++) {
        const point = points[i]!;
        const x = a[point]! * ratio - half;
        const y = b[point]! * ratio - half;
        // A place that is no number is nowhere.
        if (!(x >= 0 && y >= 0 && x <= right && y <= bottom)) continue;
        const colour = colours[codes ? codes[point]! : 0]!;
        let start = ((y + 0.5) | 0) * width + ((x + 0.5) | 0);
        for (let down = 0; down < edge; down++, start += width) {
          for (let across = 0; across < edge; across++) pixels[start + across] = colour;
        }
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

/** The points with each code below *count*, in their order. */
export function sorted(codes: Uint8Array, count: number): Int32Array[] {
  const start = new Int32Array(count + 1);
  for (let point = 0; point < codes.length; point++) start[codes[point]! + 1]!++;
  for (let code = 0; code < count; code++) start[code + 1]! += start[code]!;
  const points = new Int32Array(codes.length);
  const next = start.slice();
  for (let point = 0; point < codes.length; point++) points[next[codes[point]!]!++] = point;
  return Array.from({ length: count }, (_, code) => points.subarray(start[code], start[code + 1]));
}

/** A colour, as `#rrggbb` or `rgb(r,g,b)`, as the four bytes of a pixel. */
export function packed(colour: string): number {
  const [red, green, blue] = colour.startsWith("#")
    ? channels(colour)
    : (colour.match(/\d+/g)!.map(Number) as [number, number, number]);
  return ((255 << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}
