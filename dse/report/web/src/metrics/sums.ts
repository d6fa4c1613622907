// Sums and searches as numpy makes them, so that results are equal to the last bit and no verdict at a bound differs.

/** The sum in numpy's order: by eights in blocks of up to 128 rows, halves of longer ones apart. */
export function sum(values: Float64Array): number {
  const size = values.length;
  if (size > 128) {
    const half = (size >> 4) << 3;
    return sum(values.subarray(0, half)) + sum(values.subarray(half));
  }
  const eights = size - (size % 8);
  let total = 0;
  if (eights) {
    const part = values.slice(0, 8);
    for (let row = 8; row < eights; row++) part[row % 8]! += values[row]!;
    const pair = (first: number): number => part[first]! + part[first + 1]!;
    total = pair(0) + pair(2) + (pair(4) + pair(6));
  }
  for (let row = eights; row < size; row++) total += values[row]!;
  return total;
}

/** The sums up to each row. */
export function cumulative(values: Float64Array): Float64Array {
  let total = 0;
  return values.map((value) => (total += value));
}

/** How many of ascending *values* are below *limit*. */
export const below = (values: Float64Array, limit: number): number => countWhile(values, (value) => value < limit);

/** How many of ascending *values* are not above *limit*. */
export const upTo = (values: Float64Array, limit: number): number => countWhile(values, (value) => value <= limit);

function countWhile(values: Float64Array, holds: (value: number) => boolean): number {
  let low = 0;
  let high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (holds(values[middle]!)) low = middle + 1;
    else high = middle;
  }
  return low;
}
