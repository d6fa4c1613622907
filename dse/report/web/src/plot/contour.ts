// Regions of a field, as rings of pixels.
import { contours } from "d3-contour";
import type { Grid } from "../plane/fields";
import type { Frame } from "./frame";

export type Ring = [number, number][];

/** Where the field is greater than `level`. */
export function above(field: Float64Array, grid: Grid, frame: Frame, level: number): Ring[] {
  // d3-contour counts the level itself as inside; a bound is still met there.
  return outline(field, grid, frame, level + 1e-9 * Math.max(Math.abs(level), 1e-3));
}

/** Where the field is less than `level`. */
export function below(field: Float64Array, grid: Grid, frame: Frame, level: number): Ring[] {
  return above(
    field.map((value) => -value),
    grid,
    frame,
    -level,
  );
}

export function path(rings: Ring[]): Path2D {
  const traced = new Path2D();
  for (const ring of rings) {
    traced.moveTo(ring[0]![0], ring[0]![1]);
    for (let i = 1; i < ring.length; i++) traced.lineTo(ring[i]![0], ring[i]![1]);
    traced.closePath();
  }
  return traced;
}

/** Everything but the rings, for clipping with the even-odd rule. */
export function outside(rings: Ring[]): Path2D {
  const traced = path(rings);
  traced.rect(-1e5, -1e5, 2e5, 2e5);
  return traced;
}

function outline(field: Float64Array, grid: Grid, frame: Frame, level: number): Ring[] {
  const xs = grid.xs.map((value) => frame.x(value));
  const ys = grid.ys.map((value) => frame.y(value));
  const shape = contours().size([xs.length, ys.length]).contour(field as unknown as number[], level);
  return shape.coordinates.flatMap((polygon) =>
    polygon.map((ring) => ring.map(([a, b]): [number, number] => [between(xs, a! - 0.5), between(ys, b! - 0.5)])),
  );
}

// The place of a fractional index; d3-contour closes regions half a cell beyond the rim.
function between(places: Float64Array, index: number): number {
  const cell = Math.min(places.length - 2, Math.max(0, Math.floor(index)));
  return places[cell]! + (index - cell) * (places[cell + 1]! - places[cell]!);
}
