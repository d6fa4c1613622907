// Scattered runs: radial interpolation with the weights computed by dse/report/interpolation/radial.py.
import type { Radial, Study } from "../study";
import { even, type Fields, remember } from "./fields";

const SIZE = 81;
const LEAST = 31;

/** Of so many *cases* each is coarser: a page has to answer. */
export function radialFields(study: Study, radial: Radial, x: number, y: number, fixed: number[], cases = 1): Fields {
  const size = Math.max(LEAST, Math.round(SIZE / Math.sqrt(Math.max(1, cases / 4))));
  const [horizontal, vertical] = [study.variables[x]!, study.variables[y]!];
  const metrics = study.metrics.length;
  const last = metrics + study.requirements.length;
  // What a repaint always needs is computed in one go: the distances cost most and are shared.
  const always = [...new Set(study.requirements.map(({ metric }) => metric))];
  for (let field = metrics; field <= last; field++) if (!isConstant(radial, field)) always.push(field);
  let first: Map<number, Float64Array> | null = null;
  const values = remember((field) => {
    first ??= evaluate(study, radial, x, y, fixed, always, size);
    return first.get(field) ?? evaluate(study, radial, x, y, fixed, [field], size).get(field)!;
  });
  const region = (field: number): Float64Array | null => (isConstant(radial, field) ? null : values(field));
  return {
    xs: even(horizontal.low, horizontal.high, size),
    ys: even(vertical.low, vertical.high, size),
    how: `Boundaries are interpolated with radial functions through ${radial.centres.length} runs; they are estimates between the runs.`,
    metric: (index) => values(index),
    exercised: (requirement) => region(metrics + requirement),
    // The field is that of all requirements; without some of them it is asked for only where something is unknown at all.
    known: (requirements) =>
      requirements.every((index) => isWhole(study, radial, index)) && radial.centres.every((run) => study.done[run])
        ? null
        : region(last),
  };
}

function isWhole(study: Study, { centres }: Radial, requirement: number): boolean {
  const { metric, exercised } = study.requirements[requirement]!;
  const { values } = study.metrics[metric]!;
  return centres.every((run) => !exercised[run] || Number.isFinite(values[run]!));
}

// Only a field that is 1 at every run has no weights; one that is 0 everywhere must still be drawn.
function isConstant(radial: Radial, field: number): boolean {
  const n = radial.centres.length;
  const weights = radial.weights.subarray(field * (n + 1), (field + 1) * (n + 1));
  return Math.abs(weights[n]! - 1) < 1e-4 && weights.subarray(0, n).every((weight) => Math.abs(weight) < 1e-6);
}

function evaluate(
  study: Study,
  { centres, weights, middle, spread }: Radial,
  x: number,
  y: number,
  fixed: number[],
  fields: number[],
  size: number,
): Map<number, Float64Array> {
  const n = centres.length;
  const beside = new Float64Array(n);
  study.variables.forEach((variable, index) => {
    if (index === x || index === y) return;
    const scale = variable.high - variable.low;
    for (let c = 0; c < n; c++) beside[c]! += ((variable.values[centres[c]!]! - fixed[index]!) / scale) ** 2;
  });
  const across = squares(study, centres, x, size);
  const along = squares(study, centres, y, size);
  const rows = fields.map((field) => Float64Array.from(weights.subarray(field * (n + 1), (field + 1) * (n + 1))));
  const results = fields.map(() => new Float64Array(size * size));
  const distance = new Float64Array(n);
  for (let j = 0; j < size; j++) {
    for (let i = 0; i < size; i++) {
      for (let c = 0; c < n; c++) distance[c] = Math.sqrt(across[i * n + c]! + along[j * n + c]! + beside[c]!);
      for (let f = 0; f < rows.length; f++) {
        const row = rows[f]!;
        let sum = row[n]!;
        for (let c = 0; c < n; c++) sum += row[c]! * distance[c]!;
        const field = fields[f]!;
        // Metrics were interpolated as asinh((value - middle) / spread).
        results[f]![j * size + i] = field < middle.length ? middle[field]! + spread[field]! * Math.sinh(sum) : sum;
      }
    }
  }
  return new Map(fields.map((field, f) => [field, results[f]!]));
}

// Squared distance of every centre to each of *size* even places along one variable, scaled to 0 … 1.
function squares(study: Study, centres: Int32Array, index: number, size: number): Float64Array {
  const { values, low, high } = study.variables[index]!;
  const result = new Float64Array(size * centres.length);
  for (let i = 0; i < size; i++) {
    for (let c = 0; c < centres.length; c++) {
      result[i * centres.length + c] = ((values[centres[c]!]! - low) / (high - low) - i / (size - 1)) ** 2;
    }
  }
  return result;
}
