// The plane of two design variables that is shown: which runs lie in it, and the fields between them.

import { group } from "../format";
import { conditionsOf, poolOf } from "../points";
import type { State } from "../store";
import type { Study, Variable } from "../study";
import type { Fields } from "./fields";
import { latticeFields, latticeOf } from "./lattice";
import { radialFields } from "./radial";
import { worstOf } from "./worst";

export interface Plane {
  x: number;
  y: number;
  /** Runs in the plane; of a design at several conditions the first. */
  on: Int32Array;
  /** Runs beside the plane that are shown all the same, and how strongly (0 … 1). */
  beside: Int32Array;
  strength: Float32Array;
  fields: Fields | null;
  /** Why there are no fields, or how they were made. */
  note: string;
}

type Shown = Pick<State, "configuration" | "x" | "y" | "fixed">;

export function createPlanes(study: Study): (state: Shown) => Plane {
  let key = "";
  let plane: Plane | null = null;
  return (state) => {
    const wanted = [
      state.configuration,
      state.x,
      state.y,
      ...others(study, state.x, state.y).map((i) => state.fixed[i]),
    ].join();
    if (!plane || key !== wanted) {
      plane = makePlane(study, state);
      key = wanted;
    }
    return plane;
  };
}

/** Whether the study has a plane to show. */
export function plotted(study: Study): boolean {
  return study.variables.length >= 2;
}

/** The variables that are on neither axis. */
export function others(study: Study, x: number, y: number): number[] {
  return study.variables.map((_, index) => index).filter((index) => index !== x && index !== y);
}

/** The others that the reader may move: in a sliced study only those of a slice that has both axes. */
export function movable(study: Study, x: number, y: number): number[] {
  const rest = others(study, x, y);
  if (study.sampler !== "sliced") return rest;
  const slice = study.slices.find((names) => names.includes(x) && names.includes(y));
  return rest.filter((index) => slice?.includes(index));
}

/** The values a variable takes in the runs, in order. */
export function levels(study: Study, index: number): number[] {
  return [...new Set(study.variables[index]!.values)].sort((a, b) => a - b);
}

/** Where the variables that are on no axis start: at their nominal value, or at the level nearest to it; a condition at
 * all of its values. */
export function startingPoint(study: Study): number[] {
  return study.variables.map((variable, index) => {
    if (variable.role === "condition") return NaN;
    if (study.sampler === "scattered") return variable.nominal;
    let best = variable.nominal;
    let least = Infinity;
    for (const level of levels(study, index)) {
      if (Math.abs(level - variable.nominal) < least) {
        least = Math.abs(level - variable.nominal);
        best = level;
      }
    }
    return best;
  });
}

/** *fixed* moved through a run; what is at all conditions stays so. */
export function fixedThrough({ variables }: Study, fixed: number[], run: number): number[] {
  return variables.map(({ values }, index) => (Number.isNaN(fixed[index]!) ? NaN : values[run]!));
}

/** *fixed* at each condition that runs were made at, of those that it lets through. */
function cases(study: Study, { x, y, fixed }: Shown): number[][] {
  const free = conditionsOf(study).filter((index) => index !== x && index !== y && Number.isNaN(fixed[index]!));
  const found = new Map<string, number[]>();
  for (let run = 0; run < study.size; run++) {
    const values = free.map((index) => study.variables[index]!.values[run]!);
    if (found.has(values.join())) continue;
    found.set(
      values.join(),
      fixed.map((value, index) => (free.includes(index) ? study.variables[index]!.values[run]! : value)),
    );
    if (!free.length) break;
  }
  return [...found.values()];
}

export function liesIn(study: Study, run: number, { configuration, x, y, fixed }: Shown): boolean {
  return (
    study.configuration[run] === configuration &&
    others(study, x, y).every((index) => {
      const { values, low, high } = study.variables[index]!;
      return Number.isNaN(fixed[index]!) || Math.abs(values[run]! - fixed[index]!) <= 1e-9 * (high - low);
    })
  );
}

function makePlane(study: Study, shown: Shown): Plane {
  const { configuration, x, y } = shown;
  const base = { x, y, beside: new Int32Array(0), strength: new Float32Array(0) };
  const [horizontal, vertical] = [study.variables[x]!, study.variables[y]!];
  if (study.sampler === "scattered") return scatteredPlane(study, shown);
  const every = Int32Array.from(study.number.keys()).filter((run) => liesIn(study, run, shown));
  const pool = poolOf(study, shown);
  const runs = pool ? every.filter((run) => pool.first[pool.of[run]!] === run) : every;
  const sliced = study.sampler === "sliced" && !study.slices.some((names) => names.includes(x) && names.includes(y));
  // Of a grid that is being made there are no levels yet to interpolate to.
  const spans = [horizontal, vertical].every(
    ({ values, levels }) => new Set(Array.from(every, (run) => values[run])).size >= levels,
  );
  const named = namedAxis(study, x, y);
  const lattices =
    sliced || !spans || named
      ? []
      : cases(study, shown).map((fixed) =>
          latticeOf(
            horizontal.values,
            vertical.values,
            every.filter((run) => liesIn(study, run, { ...shown, fixed })),
          ),
        );
  const first = lattices[0];
  if (first && lattices.every((one) => one?.xs.join() === first.xs.join() && one.ys.join() === first.ys.join())) {
    const fields = worstOf(lattices.map((lattice) => latticeFields(study, lattice!)));
    return { ...base, on: runs, fields, note: fields.how };
  }
  const why = sliced
    ? "These two variables were not varied together in this study: only the runs are shown, no boundaries."
    : named && runs.length
      ? nothingBetween(named)
      : runs.length
        ? "Too few runs of this plane have been made: only the runs are shown, no boundaries."
        : `No run of configuration ${study.configurations[configuration]?.id ?? ""} is in this plane.`;
  return { ...base, on: runs, fields: null, note: why };
}

/** The first axis whose values are names, or so few or so far apart that nothing is known between them. */
function namedAxis(study: Study, x: number, y: number): Variable | undefined {
  return [study.variables[x]!, study.variables[y]!].find(({ labels, apart }) => labels.length + apart.length > 0);
}

function nothingBetween({ title, labels }: Variable): string {
  const what = labels.length ? "There is nothing" : "Nothing is known";
  return `${what} between the values of ${title}: only the runs are shown, no boundaries.`;
}

function scatteredPlane(study: Study, shown: Shown): Plane {
  const { configuration, x, y, fixed } = shown;
  const on: number[] = [];
  const beside: number[] = [];
  const strength: number[] = [];
  const rest = others(study, x, y).filter((index) => !Number.isNaN(fixed[index]!));
  const pool = poolOf(study, { x, y, fixed });
  for (let run = 0; run < study.size; run++) {
    if (
      study.configuration[run] !== configuration ||
      (pool && (pool.of[run]! < 0 || pool.first[pool.of[run]!] !== run))
    )
      continue;
    let square = 0;
    for (const index of rest) {
      const { values, low, high } = study.variables[index]!;
      square += ((values[run]! - fixed[index]!) / (high - low)) ** 2;
    }
    const away = Math.sqrt(square / Math.max(1, rest.length));
    if (away < 1e-9) on.push(run);
    else {
      beside.push(run);
      strength.push(Math.max(0.1, 1 - 2.2 * away));
    }
  }
  const radial = study.configurations[configuration]?.radial ?? null;
  const named = namedAxis(study, x, y);
  const at = cases(study, shown);
  const fields =
    radial && !named ? worstOf(at.map((each) => radialFields(study, radial, x, y, each, at.length))) : null;
  const most = study.mostCentres;
  const faint = rest.length ? " Runs away from this plane are drawn fainter." : "";
  const note = fields
    ? fields.how + faint
    : named
      ? nothingBetween(named)
      : on.length + beside.length > most
        ? `More than ${group(most)} scattered runs: interpolating through all of them is too slow for a page, so only the runs are shown.`
        : "Too few runs to interpolate: only the runs are shown.";
  return {
    x,
    y,
    on: Int32Array.from(on),
    beside: Int32Array.from(beside),
    strength: Float32Array.from(strength),
    fields,
    note,
  };
}
