// TOPSIS (Hwang and Yoon 1981): how near an alternative is to the best of all criteria, and how far from the worst.
import type { Aim } from "./front";

export interface Criterion extends Aim {
  weight: number;
}

/** The closeness of the points *among*, 0 … 1; NaN of others, where a value is not finite, and where all are alike.
 * Criteria are divided by the square root of their sum of squares (vector normalisation); weights count by their share. */
export function topsis(criteria: readonly Criterion[], among: Uint8Array): Float64Array {
  const sound = among.map((one, point) =>
    one && criteria.every(({ values }) => Number.isFinite(values[point]!)) ? 1 : 0,
  );
  const total = criteria.reduce((sum, { weight }) => sum + weight, 0);
  const toBest = new Float64Array(among.length);
  const toWorst = new Float64Array(among.length);
  for (const { values, maximize, weight } of criteria) {
    let squares = 0;
    let low = Infinity;
    let high = -Infinity;
    for (let point = 0; point < sound.length; point++) {
      if (!sound[point]) continue;
      squares += values[point]! ** 2;
      low = Math.min(low, values[point]!);
      high = Math.max(high, values[point]!);
    }
    const factor = squares > 0 ? weight / total / Math.sqrt(squares) : 0;
    const [best, worst] = maximize ? [high, low] : [low, high];
    for (let point = 0; point < sound.length; point++) {
      if (!sound[point]) continue;
      toBest[point]! += (factor * (values[point]! - best)) ** 2;
      toWorst[point]! += (factor * (values[point]! - worst)) ** 2;
    }
  }
  return toWorst.map((square, point) =>
    sound[point] ? Math.sqrt(square) / (Math.sqrt(square) + Math.sqrt(toBest[point]!)) : NaN,
  );
}
