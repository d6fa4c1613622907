import { deepEqual, ok, throws } from "node:assert/strict";
import test from "node:test";
import file from "../../../../tests/metric_program_cases.json";
import { type MetricProgram, runProgram } from "../src/metrics/program";

type Written = number | string;
type Recipe = [number, number, number, number, number, number];
interface Case {
  rows: number;
  recipes: Record<string, Recipe>;
  holes: Record<string, Record<string, Written>>;
  values: Record<string, Written>;
  metrics: Written[];
  verdicts: number[];
  margins: Written[];
}
const program = file.program as unknown as MetricProgram;
const cases = file.cases as unknown as Case[];
const ITEMS = ["a.seen", "a.mode"];

// As `_column` in tests/metric_program_cases.py.
function column({ rows, recipes, holes }: Case, name: string): Float64Array {
  const [level, slope, swing, stride, phase, modulus] = recipes[name]!.map(Number) as Recipe;
  const made = Float64Array.from(
    { length: rows },
    (_, row) => level + slope * row + swing * (((row * stride + phase) % modulus) / modulus),
  );
  for (const [row, value] of Object.entries(holes[name] ?? {})) made[Number(row)] = Number(value);
  return ITEMS.includes(name) ? made.map(Math.floor) : made;
}

const run = (of: Case) =>
  runProgram(
    program,
    column(of, "time"),
    Object.fromEntries(Object.keys(program.signals).map((name) => [name, column(of, name)])),
    Object.fromEntries(Object.entries(of.values).map(([name, value]) => [name, Number(value)])),
  );

/** Those that differ by more than the last bits, which powers may: all else, also each sum, is in the order of numpy. */
function different(found: Record<string, number>, wanted: Written[]): unknown[] {
  return Object.entries(found)
    .map(([name, value], place) => [name, value, Number(wanted[place])] as const)
    .filter(
      ([, a, b]) => !(Object.is(a, b) || a === b || Math.abs(a - b) <= 1e-15 * Math.min(Math.abs(a), Math.abs(b))),
    );
}

test("metrics, margins and verdicts of a run are those that Python computes", () => {
  for (const each of cases) {
    const { metrics, verdicts, margins } = run(each);
    deepEqual([different(metrics, each.metrics), different(margins, each.margins)], [[], []]);
    deepEqual(Object.values(verdicts), each.verdicts);
    deepEqual([Object.keys(metrics).length, Object.keys(margins).length], [each.metrics.length, each.margins.length]);
  }
  ok(new Set(cases.flatMap(({ verdicts }) => verdicts)).size === 3);
});

test("a waveform, a value and a function that are missing are named", () => {
  const time = Float64Array.of(0);
  throws(() => runProgram(program, time, {}, {}), /'a\.x'/);
  throws(() => runProgram({ ...program, signals: {} }, time, {}, {}), /'c\.target'/);
  const unknown = { ...program, signals: {}, constants: {}, instructions: [["toString", 1]] } as MetricProgram;
  throws(() => runProgram(unknown, time, {}, {}), /'toString'/);
});
