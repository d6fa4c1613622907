// Continuous fields over the plane of two variables, given row by row at the nodes of a grid.

/** Node `j * xs.length + i` lies at `xs[i]`, `ys[j]`; both rise, their spacing may vary. */
export interface Grid {
  xs: Float64Array;
  ys: Float64Array;
}

/** `size` even places from `low` to `high`. */
export function even(low: number, high: number, size: number): Float64Array {
  return Float64Array.from({ length: size }, (_, i) => low + ((high - low) * i) / (size - 1));
}

/** Which of the values at several conditions: the largest, the smallest, or their mean. */
export type Way = "max" | "min" | "mean";

export interface Fields extends Grid {
  /** How the fields come from the runs, in words. */
  how: string;
  /** Where there are several conditions, *way* of those at which the *requirement* is exercised. */
  metric(index: number, way?: Way, requirement?: number): Float64Array;
  /** 0.5 or more where the requirement is exercised; null if it is everywhere. */
  exercised(requirement: number): Float64Array | null;
  /** 0.5 or more where the *requirements* have a value; null if they have everywhere. */
  known(requirements: readonly number[]): Float64Array | null;
}

/** Remembers the result for each argument. */
export function remember<T, K = number>(make: (key: K) => T): (key: K) => T {
  const made = new Map<K, T>();
  return (key) => {
    if (!made.has(key)) made.set(key, make(key));
    return made.get(key)!;
  };
}
