// From waveforms to numbers: what dse/metrics/functions.py defines and explains, in the same order of operations.
// Both are tested with tests/metric_program_cases.json.

import { type Column, timeToCollision } from "./rowwise";
import { below, cumulative, sum, upTo } from "./sums";

type Waveform = Float64Array;

/** Rows from *start* on, without *stop*. */
export interface Rows {
  start: number;
  stop: number;
}

/** By the names they have in Python. */
export const FUNCTIONS: Record<string, (...values: never[]) => Column | Rows> = {
  rise_time: riseTime,
  reach_time: reachTime,
  settling_time: settlingTime,
  steady_state_error: steadyStateError,
  minimum: (x: Waveform) => least(x),
  maximum: (x: Waveform) => x.reduce((a, b) => Math.max(a, b)),
  initial: (x: Waveform) => x[0]!,
  final: (x: Waveform) => last(x),
  at_first: (x: Waveform, condition: Waveform) => x[condition.indexOf(1)] ?? NaN,
  time_to_collision: timeToCollision,
  driver_gap: driverGap,
  relative_excess: (peak: number, target: number) => (target ? (peak - target) / Math.abs(target) : NaN),
  relative_shortfall: (lowest: number, target: number) => (target ? (target - lowest) / Math.abs(target) : NaN),
  row_widths: rowWidths,
  rows_within: rowsWithin,
  within: (x: Waveform, { start, stop }: Rows) => (start < stop ? x.subarray(start, stop) : x.subarray(0, 1)),
  of_rows: (value: number, { start, stop }: Rows) => (start < stop ? value : NaN),
  weighted_sum: weightedSum,
  average,
  root_average_square: (x: Waveform, widths: Waveform) =>
    Math.sqrt(
      average(
        x.map((value) => value * value),
        widths,
      ),
    ),
  percentile,
  rolling_mean: rollingMean,
  time_held: (condition: Waveform, widths: Waveform) => sum(widths.filter((_, row) => condition[row])),
  occurrences: (condition: Waveform) => condition.filter((held, row) => held && !condition[row - 1]).length,
};

const last = (x: Waveform): number => x[x.length - 1]!;
const least = (x: Waveform): number => x.reduce((a, b) => Math.min(a, b));

function riseTime(time: Waveform, x: Waveform, target: number): number {
  const start = x[0]!;
  const way = target - start;
  if (!way) return NaN;
  return crossing(time, x, start + 0.9 * way, way > 0) - crossing(time, x, start + 0.1 * way, way > 0);
}

function reachTime(time: Waveform, x: Waveform, target: number, band: number): number {
  const [low, high] = limits(target, band);
  const start = x[0]!;
  if (low <= start && start <= high) return 0;
  return crossing(time, x, start < low ? low : high, start < low) - time[0]!;
}

function settlingTime(time: Waveform, x: Waveform, target: number, band: number): number {
  const [low, high] = limits(target, band);
  let outside = x.length - 1;
  while (outside >= 0 && low <= x[outside]! && x[outside]! <= high) outside--;
  if (outside < 0) return 0;
  if (outside === x.length - 1) return NaN;
  return between(time, x, outside, x[outside]! < low ? low : high) - time[0]!;
}

function steadyStateError(time: Waveform, x: Waveform, target: number, window: number): number {
  const end = last(time);
  const slack = 1e-9 * Math.max(Math.abs(end), window);
  const start = end - window - slack;
  if (time[0]! - start > 2 * slack || !(window >= 0)) return NaN;
  const tail = x.subarray(below(time, start));
  return sum(tail) / tail.length - target;
}

function driverGap(
  time: Waveform,
  gap: Waveform,
  speed: Waveform,
  risk: Waveform,
  delay: number,
  deceleration: number,
  jerk: number,
): number {
  const first = risk.indexOf(1);
  if (first < 0 || !(deceleration > 0 && jerk > 0 && delay >= 0)) return NaN;
  const since = time.subarray(first).map((now) => now - time[first]!);
  const moved = speed.subarray(first);
  const own = cumulative(
    since.map((now, row) => (row ? ((now - since[row - 1]!) * (moved[row]! + moved[row - 1]!)) / 2 : 0)),
  );
  const start = moved[0]!;
  const built = deceleration / jerk;
  const held = start - (jerk * built ** 2) / 2;
  const stop = held > 0 ? built + held / deceleration : Math.sqrt((2 * Math.max(start, 0)) / jerk);
  return least(
    since.map((now, row) => {
      const braking = Math.min(Math.max(now - delay, 0), stop);
      const rising = Math.min(braking, built);
      const full = Math.max(braking - built, 0);
      const way =
        start * (Math.min(now, delay) + rising) -
        (jerk * rising ** 3) / 6 +
        held * full -
        (deceleration * full ** 2) / 2;
      return gap[first + row]! + own[row]! - way;
    }),
  );
}

function rowWidths(time: Waveform): Waveform {
  const end = time.length - 1;
  return time.map((_, row) => (time[Math.min(row + 1, end)]! - time[Math.max(row - 1, 0)]!) * 0.5);
}

function rowsWithin(time: Waveform, start: number, end: number): Rows {
  const slack = 1e-9 * Math.max(Math.abs(start), Math.abs(end), Math.abs(last(time)));
  return { start: below(time, start - slack), stop: upTo(time, end + slack) };
}

function weightedSum(x: Waveform, widths: Waveform): number {
  return sum(x.map((value, row) => value * widths[row]!));
}

function average(x: Waveform, widths: Waveform): number {
  const span = sum(widths);
  return span ? weightedSum(x, widths) / span : NaN;
}

function percentile(x: Waveform, widths: Waveform, q: number): number {
  if (!(q >= 0 && q <= 1 && widths.some(Boolean)) || x.some(Number.isNaN)) return NaN;
  const order = Uint32Array.from(x.keys()).sort((a, b) => x[a]! - x[b]!);
  const until = cumulative(Float64Array.from(order, (row) => widths[row]!));
  // A share of 0 asks for the first row that has a width.
  const shares = until.map((held) => held / last(until) || -1);
  return x[order[below(shares, q)]!]!;
}

function rollingMean(time: Waveform, x: Waveform, window: number): Waveform {
  const begin = time[0]!;
  const slack = 1e-9 * Math.max(Math.abs(last(time)), window);
  if (!(window > 0 && last(time) - begin >= window - slack)) return new Float64Array(x.length).fill(NaN);
  const holes = cumulative(x.map((value) => Number(!Number.isFinite(value))));
  const flat = x.map((value) => (Number.isFinite(value) ? value : 0));
  const area = cumulative(
    flat.map((value, row) => (row ? 0.5 * (value + flat[row - 1]!) * (time[row]! - time[row - 1]!) : 0)),
  );
  const means = time.map((now, row) => {
    const start = Math.max(now - window, begin);
    const first = Math.max(Math.min(upTo(time, start + slack) - 1, time.length - 2), 0);
    if (holes[row]! > (holes[first - 1] ?? 0)) return NaN;
    const past = start - time[first]!;
    const step = time[first + 1]! - time[first]!;
    const slope = step > 0 ? (flat[first + 1]! - flat[first]!) / step : 0;
    const before = area[first]! + past * (flat[first]! + 0.5 * slope * past);
    return (area[row]! - before) / window;
  });
  const whole = below(time, begin + window - slack);
  return means.fill(means[whole]!, 0, whole);
}

function limits(target: number, band: number): [number, number] {
  const half = band >= 0 ? Math.abs(band * target) : NaN;
  return [target - half, target + half];
}

/** When *x* first comes to *level*; NaN if it does not. */
function crossing(time: Waveform, x: Waveform, level: number, rising: boolean): number {
  const first = x.findIndex((value) => (rising ? value >= level : value <= level));
  if (first < 0) return NaN;
  return first ? between(time, x, first - 1, level) : time[0]!;
}

/** When *x* comes to *level* between *row* and the next. */
function between(time: Waveform, x: Waveform, row: number, level: number): number {
  const share = (level - x[row]!) / (x[row + 1]! - x[row]!);
  return time[row]! + share * (time[row + 1]! - time[row]!);
}
