// Two designs in the same draws, as dse/analysis/paired.py has it: both are tested with tests/pair_cases.json.

/** The 97.5 % quantile. */
export const NORMAL = 1.959963984540054;

export interface Interval {
  value: number;
  low: number;
  high: number;
}

/** How many draws both, one or neither meets; the mean difference of the margins with its standard error (0 without
 * noise, NaN of a single draw), and that of the rates, first less second, with 95 %. */
export interface Counts {
  both: number;
  first: number;
  second: number;
  neither: number;
  margin: number;
  error: number;
  difference: Interval;
}

/** Margins of the same draws. */
export function counted(first: number[], second: number[], random: boolean): Counts {
  const n = first.length;
  const among = (one: boolean, other: boolean): number =>
    first.filter((margin, draw) => margin >= 0 === one && second[draw]! >= 0 === other).length;
  const [b, c] = [among(true, false), among(false, true)];
  const value = (b - c) / n;
  const centre = (b - c) / (n + 2);
  const half = (NORMAL * Math.sqrt(Math.max(b + c + 1 - (b - c) ** 2 / (n + 2), 0))) / (n + 2);
  const differences = first.map((margin, draw) => margin - second[draw]!);
  const margin = mean(differences);
  const square = differences.reduce((sum, each) => sum + (each - margin) ** 2, 0);
  return {
    both: among(true, true),
    first: b,
    second: c,
    neither: among(false, false),
    margin,
    error: !random ? 0 : n > 1 ? Math.sqrt(square / (n - 1) / n) : NaN,
    difference: random
      ? { value, low: Math.max(-1, centre - half), high: Math.min(1, centre + half) }
      : { value, low: value, high: value },
  };
}

/** The share of the random draws which only one design meets that the first one meets; NaN of none, then 0 … 1. */
export function leading(pairs: Pick<Counts, "first" | "second" | "difference">[]): Interval {
  const random = pairs.filter(({ difference }) => difference.low < difference.high);
  const b = random.reduce((sum, { first }) => sum + first, 0);
  const n = b + random.reduce((sum, { second }) => sum + second, 0);
  return { value: b / n, low: lowest(b, n), high: 1 - lowest(n - b, n) };
}

const HALVINGS = 60;
const ERROR = 0.025;

/** The lower end of Clopper and Pearson's interval: the rate at which so many of n are as rare as that. */
function lowest(met: number, n: number): number {
  if (!met) return 0;
  const logs = new Float64Array(n + 1);
  for (let k = 1; k <= n; k++) logs[k] = logs[k - 1]! + Math.log(k);
  let [low, high] = [0, met / n];
  for (let step = 0; step < HALVINGS; step++) {
    const rate = (low + high) / 2;
    let tail = 0;
    for (let k = met; k <= n; k++)
      tail += Math.exp(
        logs[n]! - logs[k]! - logs[n - k]! + k * Math.log(rate) + (n - k ? (n - k) * Math.log1p(-rate) : 0),
      );
    if (tail < ERROR) low = rate;
    else high = rate;
  }
  return (low + high) / 2;
}

export function mean(values: number[]): number {
  return values.reduce((sum, each) => sum + each, 0) / values.length;
}
