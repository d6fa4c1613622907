// Runs on a grid of levels: linear interpolation along the edges of the grid, exact at every run.
import type { Study } from "../study";
import { type Fields, remember } from "./fields";

const MOST_LEVELS = 240;

/** Levels of two variables and the run at each node (row by row), -1 where there is none. */
export interface Lattice {
  xs: Float64Array;
  ys: Float64Array;
  runs: Int32Array;
  /** Whether every level is there; boundaries through more levels than there are pixels would only cost time. */
  whole: boolean;
}

/** The lattice the runs lie on; null if they fill less than half of one. */
export function latticeOf(x: Float64Array, y: Float64Array, runs: Int32Array): Lattice | null {
  const all = { xs: distinct(x, runs), ys: distinct(y, runs) };
  if (all.xs.length < 2 || all.ys.length < 2 || runs.length < 0.5 * all.xs.length * all.ys.length) return null;
  const xs = thinned(all.xs);
  const ys = thinned(all.ys);
  const column = new Map(Array.from(xs, (value, i) => [value, i]));
  const row = new Map(Array.from(ys, (value, j) => [value, j]));
  const nodes = new Int32Array(xs.length * ys.length).fill(-1);
  for (const run of runs) {
    const i = column.get(x[run]!);
    const j = row.get(y[run]!);
    if (i !== undefined && j !== undefined) nodes[j * xs.length + i] = run;
  }
  return { xs, ys, runs: nodes, whole: xs === all.xs && ys === all.ys };
}

export function latticeFields(study: Study, lattice: Lattice): Fields {
  const { xs, ys, runs } = lattice;
  const wide = xs.length;
  const done = Uint8Array.from(runs, (run) => (run >= 0 && study.done[run] ? 1 : 0));
  const region = (inside: Uint8Array): Float64Array | null => (inside.every(Boolean) ? null : divided(inside, wide));
  // Keyed by a text, because a list is equal only to itself.
  const known = remember((requirements: string) => {
    const asked = requirements ? requirements.split(",").map((index) => study.requirements[Number(index)]!) : [];
    const hasValue = (run: number): boolean =>
      asked.every(({ metric, exercised }) => !exercised[run] || Number.isFinite(study.metrics[metric]!.values[run]!));
    return region(Uint8Array.from(runs, (run, node) => (done[node] && hasValue(run) ? 1 : 0)));
  });
  return {
    xs,
    ys,
    how: lattice.whole
      ? "Boundaries are interpolated linearly between the runs of the grid."
      : `Boundaries are interpolated linearly on ${wide} \u00d7 ${ys.length} of the levels; every run is drawn.`,
    metric: remember((index) => {
      const values = study.metrics[index]!.values;
      const nodes = Float64Array.from(runs, (run) => (run >= 0 ? values[run]! : NaN));
      const known = Uint8Array.from(nodes, (value, node) => (done[node] && Number.isFinite(value) ? 1 : 0));
      return filled(nodes, known, wide);
    }),
    exercised: remember((index) => {
      const { exercised } = study.requirements[index]!;
      const nodes = Float64Array.from(runs, (run) => (run >= 0 && exercised[run] ? 1 : 0));
      return region(Uint8Array.from(filled(nodes, done, wide), (value) => (value >= 0.5 ? 1 : 0)));
    }),
    known: (requirements) => known(requirements.join()),
  };
}

function distinct(values: Float64Array, runs: Int32Array): Float64Array {
  return Float64Array.from(new Set(Array.from(runs, (run) => values[run]!))).sort();
}

// Unknown nodes take the mean of their known neighbours, from the rim of each hole inwards.
function filled(nodes: Float64Array, known: Uint8Array, wide: number): Float64Array {
  const values = nodes.slice();
  const set = known.slice();
  let open = Array.from(values.keys()).filter((node) => !set[node]);
  while (open.length) {
    const found: [number, number][] = [];
    const rest: number[] = [];
    for (const node of open) {
      const around = neighbours(node, wide, values.length).filter((other) => set[other]);
      if (around.length) found.push([node, around.reduce((sum, other) => sum + values[other]!, 0) / around.length]);
      else rest.push(node);
    }
    if (!found.length) return values.fill(0);
    for (const [node, value] of found) {
      values[node] = value;
      set[node] = 1;
    }
    open = rest;
  }
  return values;
}

// A yes/no field drawn as it is has a staircase for a boundary. Here the boundary is relaxed as far as it goes
// while every node stays clearly on its own side of 0.5.
function divided(inside: Uint8Array, wide: number): Float64Array {
  const rounds = inside.length > 100_000 ? 6 : 60;
  let values = Float64Array.from(inside);
  for (let round = 0; round < rounds; round++) {
    const next = new Float64Array(values.length);
    for (let node = 0; node < values.length; node++) {
      const column = node % wide;
      const west = column > 0 ? node - 1 : node;
      const east = column < wide - 1 ? node + 1 : node;
      const south = node >= wide ? node - wide : node;
      const north = node + wide < values.length ? node + wide : node;
      const mean = (values[west]! + values[east]! + values[south]! + values[north]!) / 4;
      const relaxed = 0.3 * values[node]! + 0.7 * mean;
      next[node] = inside[node] ? Math.max(relaxed, 0.62) : Math.min(relaxed, 0.38);
    }
    values = next;
  }
  return values;
}

function neighbours(node: number, wide: number, size: number): number[] {
  const column = node % wide;
  const around: number[] = [];
  if (column > 0) around.push(node - 1);
  if (column < wide - 1) around.push(node + 1);
  if (node >= wide) around.push(node - wide);
  if (node + wide < size) around.push(node + wide);
  return around;
}

// Evenly spread levels, the first and the last among them.
function thinned(levels: Float64Array): Float64Array {
  if (levels.length <= MOST_LEVELS) return levels;
  return Float64Array.from(
    { length: MOST_LEVELS },
    (_, i) => levels[Math.round((i * (levels.length - 1)) / (MOST_LEVELS - 1))]!,
  );
}
