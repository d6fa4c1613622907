// Runs as designs: a configuration with values of its design variables, in the order of their first runs, as in
// dse/exploration/designs.py. The runs of a design differ in conditions and in what is uncertain.
import type { Study, Variable } from "../../study";

export interface Grouping {
  size: number;
  /** Design of each run. */
  of: Int32Array;
  /** First run of each design. */
  first: Int32Array;
  /** The runs of design d are rows[start[d]] … rows[start[d + 1] - 1], those at one condition together. */
  start: Int32Array;
  rows: Int32Array;
  /** Condition of each run, by its place in the order in which they came. */
  condition: Int32Array;
  conditions: number;
  /** Which designs were tried at as many conditions as any. */
  whole: Uint8Array;
}

const known = new WeakMap<Study, Grouping>();

export function groupingOf(study: Study): Grouping {
  let grouping = known.get(study);
  if (!grouping) known.set(study, (grouping = grouped(study)));
  return grouping;
}

export function variablesOf(study: Study, role: Variable["role"]): Variable[] {
  return study.variables.filter((variable) => variable.role === role);
}

function grouped(study: Study): Grouping {
  const values = (role: Variable["role"]): ArrayLike<number>[] => variablesOf(study, role).map((variable) => variable.values);
  const { codes: of, count: size } = coded([study.configuration, ...values("design")], study.size);
  const { codes: condition, count: conditions } = coded(values("condition"), study.size);
  const byCondition = sorted(Int32Array.from({ length: study.size }, (_, run) => run), condition, conditions).rows;
  const { rows, start } = sorted(byCondition, of, size);
  const first = new Int32Array(size);
  for (let run = study.size - 1; run >= 0; run--) first[of[run]!] = run;
  const tried = new Int32Array(size);
  let most = 0;
  for (let design = 0; design < size; design++) {
    for (let i = start[design]!; i < start[design + 1]!; i++) {
      if (i === start[design] || condition[rows[i]!] !== condition[rows[i - 1]!]) tried[design]!++;
    }
    most = Math.max(most, tried[design]!);
  }
  return { size, of, first, start, rows, condition, conditions, whole: Uint8Array.from(tried, (count) => (count === most ? 1 : 0)) };
}

/** Numbers 0, 1, … for rows of *columns*, the same for equal rows. */
function coded(columns: ArrayLike<number>[], size: number): { codes: Int32Array; count: number } {
  let codes = new Int32Array(size);
  let count = Math.min(1, size);
  for (const column of columns) {
    const values = new Map<number, number>();
    const pairs = new Map<number, number>();
    const next = new Int32Array(size);
    for (let row = 0; row < size; row++) {
      const value = column[row]!;
      let code = values.get(value);
      if (code === undefined) values.set(value, (code = values.size));
      // There are no more codes than runs: the product stays far below 2^53.
      const pair = codes[row]! * (size + 1) + code;
      let joined = pairs.get(pair);
      if (joined === undefined) pairs.set(pair, (joined = pairs.size));
      next[row] = joined;
    }
    codes = next;
    count = pairs.size;
  }
  return { codes, count };
}

/** *order* sorted by *codes*, what is equal as it stood. */
function sorted(order: Int32Array, codes: Int32Array, count: number): { rows: Int32Array; start: Int32Array } {
  const start = new Int32Array(count + 1);
  for (const row of order) start[codes[row]! + 1]!++;
  for (let code = 0; code < count; code++) start[code + 1]! += start[code]!;
  const next = start.slice();
  const rows = new Int32Array(order.length);
  for (const row of order) rows[next[codes[row]!]!++] = row;
  return { rows, start };
}
