// Studies that tests write down: what is not given is as in a study of one configuration without requirements.
import { columnText } from "../src/format";
import { createStore, type State, type Store, studyThresholds } from "../src/store";
import type { Column, Metric, Requirement, Study, Variable } from "../src/study";

export function column(name: string, values: ArrayLike<number>, unit = ""): Column {
  const floats = Float64Array.from(values);
  return { name, title: name, unit, values: floats, text: columnText(floats) };
}

export function variable(name: string, values: ArrayLike<number>, facts: Partial<Variable> = {}): Variable {
  const base = { low: 0, high: 1, nominal: 0, levels: 0, log: false, role: "design" } as const;
  return { ...column(name, values, facts.unit), ...base, lack: [], labels: [], apart: [], ...facts };
}

export function metric(name: string, values: ArrayLike<number>, error: ArrayLike<number> | null = null): Metric {
  return { ...column(name, values), error: error && Float64Array.from(error) };
}

export function requirement(
  size: number,
  bounds: { atMost?: number; atLeast?: number; metric?: number; exercised?: ArrayLike<number | boolean> },
): Requirement {
  return {
    name: "R",
    title: "R",
    metric: bounds.metric ?? 0,
    atMost: bounds.atMost ?? null,
    atLeast: bounds.atLeast ?? null,
    exercised: Uint8Array.from({ length: size }, (_, run) => Number(bounds.exercised?.[run] ?? 1)),
    unsettled: null,
    draws: null,
    applies: null,
    metIn: 0.95,
    level: 0,
    origin: [],
  };
}

export function studyOf(size: number, facts: Partial<Study>): Study {
  const configurations = facts.configurations ?? [
    { id: "c", choices: [], properties: [], picture: -1, parts: [], radial: null, noisy: false, allocations: [] },
  ];
  return {
    title: "made up",
    sampler: "scattered",
    size,
    mostCentres: 1000,
    number: Int32Array.from({ length: size }, (_, run) => run),
    configuration: new Int32Array(size),
    done: new Uint8Array(size).fill(1),
    checked: null,
    problems: new Map(),
    variables: [],
    metrics: [],
    requirements: [],
    properties: [],
    composites: [],
    objectives: [],
    pictures: [],
    slices: [],
    figures: [],
    charted: [],
    facts: [],
    insight: null,
    missing: [],
    notes: null,
    retried: [],
    scenes: null,
    drawn: null,
    waveforms: async () => new Map(),
    ...facts,
    configurations,
  };
}

export function stateOf(study: Study, facts: Partial<State> = {}): State {
  return {
    configuration: 0,
    x: 0,
    y: 1,
    fixed: study.variables.map(({ role, nominal }) => (role === "condition" ? NaN : nominal)),
    thresholds: studyThresholds(study),
    fill: -1,
    selected: -1,
    filter: "all",
    sort: { column: "run", descending: false },
    brushes: [],
    pins: [],
    hovered: -1,
    zoom: null,
    view: "plot",
    settings: {},
    theme: "light",
    ...facts,
  };
}

export function storeOf(study: Study, facts: Partial<State> = {}): Store {
  return createStore(study, stateOf(study, facts));
}

/** The same numbers 0 … 1 every time (Park and Miller 1988). */
export function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state * 16807) % 2147483647;
    return state / 2147483647;
  };
}

export function near(actual: number, expected: number, tolerance = 1e-12): boolean {
  return Object.is(actual, expected) || Math.abs(actual - expected) <= tolerance;
}
