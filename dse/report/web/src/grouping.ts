// Runs as designs: a configuration with values of its design variables, in the order of their first runs, as in
// dse/exploration/designs.py. The runs of a design differ in conditions and in what is uncertain.
import type { Study, Variable } from "./study";

export interface Grouping {
  size: number;
  /** Design of each run, -1 for one that is left out. */
  of: Int32Array;
  /** First run of each design. */
  first: Int32Array;
  /** The runs of design d are rows[start[d]] … rows[start[d + 1] - 1], those at one condition together. */
  start: Int32Array;
  rows: Int32Array;
  /** Condition of each run, by its place in the order in which they came. */
  condition: Int32Array;
  conditions: number;
  /** Which designs were tried at all conditions. */
  whole: Uint8Array;
}

const known = new WeakMap<Study, Grouping>();

export function groupingOf(study: Study): Grouping {
  let grouping = known.get(study);
  if (!grouping) {
    const own = valuesOf(study, ({ role }) => role === "design");
    const at = valuesOf(study, ({ role }) => role === "condition");
    grouping = grouped(study, own, at, Int32Array.from(study.number.keys()));
    known.set(study, grouping);
  }
  return grouping;
}

/** The runs *among*, grouped where they differ only in the variables *pooled*, which are conditions. */
export function pooledOver(study: Study, pooled: ReadonlySet<Variable>, among: Int32Array): Grouping {
  return grouped(
    study,
    valuesOf(study, (variable) => !pooled.has(variable)),
    valuesOf(study, (variable) => pooled.has(variable)),
    among,
  );
}

function valuesOf(study: Study, suits: (variable: Variable) => boolean): ArrayLike<number>[] {
  return study.variables.filter(suits).map(({ values }) => values);
}

export function variablesOf(study: Study, role: Variable["role"]): Variable[] {
  return study.variables.filter((variable) => variable.role === role);
}

function grouped(study: Study, own: ArrayLike<number>[], at: ArrayLike<number>[], among: Int32Array): Grouping {
  const { codes: of, count: size } = coded([study.configuration, ...own], study.size, among);
  const { codes: condition, count: conditions } = coded(at, study.size, among);
  const { rows, start } = sorted(sorted(among, condition, conditions).rows, of, size);
  const first = new Int32Array(size);
  for (let i = among.length - 1; i >= 0; i--) first[of[among[i]!]!] = among[i]!;
  const tried = new Int32Array(size);
  for (let design = 0; design < size; design++) {
    for (let i = start[design]!; i < start[design + 1]!; i++) {
      if (i === start[design] || condition[rows[i]!] !== condition[rows[i - 1]!]) tried[design]!++;
    }
  }
  return {
    size,
    of,
    first,
    start,
    rows,
    condition,
    conditions,
    whole: Uint8Array.from(tried, (count) => (count === conditions ? 1 : 0)),
  };
}

/** Numbers 0, 1, … for the rows *among* those of *columns*, the same for equal rows; -1 for others. */
function coded(columns: ArrayLike<number>[], size: number, among: Int32Array): { codes: Int32Array; count: number } {
  let codes = new Int32Array(size).fill(-1);
  for (const row of among) codes[row] = 0;
  let count = Math.min(1, among.length);
  for (const column of columns) {
    const values = new Map<number, number>();
    const pairs = new Map<number, number>();
    const next = new Int32Array(size).fill(-1);
    for (const row of among) {
      const value = column[row]!;
      let code = values.get(value);
      if (code === undefined) {
        code = values.size;
        values.set(value, code);
      }
      // There are no more codes than runs: the product stays far below 2^53.
      const pair = codes[row]! * (size + 1) + code;
      let joined = pairs.get(pair);
      if (joined === undefined) {
        joined = pairs.size;
        pairs.set(pair, joined);
      }
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
