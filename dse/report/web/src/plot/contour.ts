// Regions of a field, as rings of pixels.
import { contours } from "d3-contour";
import type { Grid } from "../plane/fields";
import type { Frame } from "./frame";
import { type Ring, Shape } from "./pen";

export type { Ring };

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

export function path(rings: Ring[]): Shape {
  return new Shape(rings);
}

/** Everything but the rings, for clipping with the even-odd rule. */
export function outside(rings: Ring[]): Shape {
  const far = 1e5;
  return path([
    ...rings,
    [
      [-far, -far],
      [far, -far],
      [far, far],
      [-far, far],
    ],
  ]);
}

function outline(field: Float64Array, grid: Grid, frame: Frame, level: number): Ring[] {
  const xs = grid.xs.map((value) => frame.x(value));
  const ys = grid.ys.map((value) => frame.y(value));
  const shape = contours()
    .size([xs.length, ys.length])
    .contour(field as unknown as number[], level);
  return shape.coordinates.flatMap((polygon) =>
    polygon.map((ring) => ring.map(([a, b]): [number, number] => [between(xs, a! - 0.5), between(ys, b! - 0.5)])),
  );
}

// The place of a fractional index; d3-contour closes regions half a cell beyond the rim.
function between(places: Float64Array, index: number): number {
  const cell = Math.min(places.length - 2, Math.max(0, Math.floor(index)));
  return places[cell]! + (index - cell) * (places[cell + 1]! - places[cell]!);
}
