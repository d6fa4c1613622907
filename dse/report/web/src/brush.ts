// Ranges that the reader drags on axes: every view sets back the runs outside of them.
import { columnOf } from "./columns";
import type { Study } from "./study";

export interface Brush {
  /** Key of a column. */
  readonly column: string;
  readonly low: number;
  readonly high: number;
}

/** Which runs lie within all *brushes*; null if there is none. A value that is undefined lies within no range. */
export function maskOf(study: Study, brushes: readonly Brush[]): Uint8Array | null {
  if (!brushes.length) return null;
  const mask = new Uint8Array(study.size).fill(1);
  for (const { column, low, high } of brushes) {
    const values = columnOf(study, column)?.values;
    if (!values) continue;
    for (let run = 0; run < mask.length; run++) if (!(values[run]! >= low && values[run]! <= high)) mask[run] = 0;
  }
  return mask;
}

// A hand aims at three digits; six are enough. Rounding outwards keeps what it caught.
function rounded(value: number, outwards: -1 | 1): number {
  const nearest = Number(value.toPrecision(6));
  if (nearest === value || Math.sign(nearest - value) === outwards) return nearest;
  const unit = 10 ** (Math.floor(Math.log10(Math.abs(value))) - 5);
  return Number((nearest + outwards * unit).toPrecision(6));
}

/** *brushes* with the one on *column* replaced, or taken away where there is no *range*. */
export function rebrushed(brushes: readonly Brush[], column: string, range: readonly [number, number] | null): Brush[] {
  const others = brushes.filter((brush) => brush.column !== column);
  return range
    ? [...others, { column, low: rounded(Math.min(...range), -1), high: rounded(Math.max(...range), 1) }]
    : others;
}
