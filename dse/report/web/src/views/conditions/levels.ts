// The values of a condition, or parts of its range where it may have any value.

import { number } from "../../format";
import type { Variable } from "../../study";

const MOST_VALUES = 12;
const PARTS = 6;

export interface Levels {
  labels: string[];
  /** For each run the position of its level. */
  of: Int32Array;
}

export function levelsOf({ values, low, high, unit, labels: names, text }: Variable): Levels {
  const distinct = [...new Set(values)].sort((a, b) => a - b);
  if (names.length || distinct.length <= MOST_VALUES) {
    const place = new Map(distinct.map((value, index) => [value, index]));
    return {
      labels: distinct.map((value) => (names.length ? text(value) : `${number(value)} ${unit}`.trim())),
      of: Int32Array.from(values, (value) => place.get(value)!),
    };
  }
  const step = (high - low) / PARTS;
  const labels = Array.from({ length: PARTS }, (_, index) =>
    `${number(low + index * step, 3)} \u2026 ${number(low + (index + 1) * step, 3)} ${unit}`.trim(),
  );
  return {
    labels,
    of: Int32Array.from(values, (value) => Math.min(PARTS - 1, Math.max(0, Math.floor((value - low) / step)))),
  };
}

/** What stands for no condition: one level that every run has. */
export function oneLevel(size: number): Levels {
  return { labels: ["all"], of: new Int32Array(size) };
}
