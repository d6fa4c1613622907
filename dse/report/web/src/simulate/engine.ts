// Simulates and measures one run after the other, in a worker; as `Runner` of dse/testbench/runner.py does natively.
import { NOT_APPLICABLE } from "../marks";
import { evaluate, runProgram } from "../metrics/program";
import { type SimulatedFigure, type SimulationDocument, type System, shown } from "./document";

export interface Trace {
  time: Float64Array;
  values: Float64Array;
  targets: Float64Array | null;
}

export interface Ran {
  /** Why the run failed; "" if it came to its end. */
  problem: string;
  /** By metric of the document, in its units; NaN where undefined, or not of this bench. */
  metrics: Float64Array;
  /** By requirement, the marks of the bench's own bounds. */
  marks: Uint8Array;
  /** Whether a margin is so small that another libm could change the verdict, by requirement. */
  close: Uint8Array;
  /** By figure, if they were asked for. */
  traces: Trace[];
  /** The columns of the system, as often as waveforms are kept, if they were asked for. */
  columns: Record<string, Float64Array>;
}

/** From the step *first* on the settings have *values*. */
export interface Change {
  first: number;
  values: Float64Array;
}

/** A run at *values* of the settings of a system (SI, in its order). */
export interface Point {
  system: number;
  draw: number;
  values: Float64Array;
  traces: boolean;
  /** In the order of their steps. */
  changes?: Change[];
  columns?: boolean;
}

/** Relative to the bound: what differences in the last bits of a function can come to. */
const CLOSE = 1e-9;

interface Exports {
  memory: WebAssembly.Memory;
  _initialize?: () => void;
  dse_web_starts(): number;
  dse_web_rows(): number;
  dse_web_said(): number;
  dse_web_step(): number;
  dse_web_begin(system: number, steps: number, stop: number): number;
  dse_web_go(system: number, first: number, last: number, step: number): number;
}

const WAYS_TO_FAIL = ["", "it cannot be started", "a component refused", "its connections do not settle", "it stopped"];

export class Engine {
  readonly #document: SimulationDocument;
  readonly #module: WebAssembly.Module;
  #instance: Exports | null = null;
  /** By system, time and columns of the last run: to get memory anew costs as much as what is done with it. */
  readonly #tables = new Map<System, Table>();

  constructor(document: SimulationDocument, module: WebAssembly.Module) {
    this.#document = document;
    this.#module = module;
  }

  run(point: Point): Ran {
    const { metrics, requirements } = this.#document;
    const ran: Ran = {
      problem: "",
      metrics: new Float64Array(metrics.length).fill(NaN),
      marks: new Uint8Array(requirements.length).fill(NOT_APPLICABLE),
      close: new Uint8Array(requirements.length),
      traces: [],
      columns: {},
    };
    try {
      this.#measure(point, ran);
    } catch (error) {
      if (error instanceof NoRun) {
        ran.problem = error.message;
        return ran;
      }
      this.#instance = null; // its memory may be anything
      ran.problem = `a component crashed: ${(error as Error).message}`;
    }
    return ran;
  }

  #measure({ system, draw, values, traces, changes = [], columns: isAll }: Point, ran: Ran): void {
    const { programs, metrics, requirements, figures, systems } = this.#document;
    const of = systems[system]!;
    this.#instance ??= instantiated(this.#module);
    const instance = this.#instance;
    const { starts, constants } = this.#given(of, values, draw);
    const take = (given: Float64Array): void =>
      new Float64Array(instance.memory.buffer, instance.dse_web_starts(), given.length).set(given);
    take(starts);
    let code = instance.dse_web_begin(system, of.steps, of.stop);
    const parts = [{ first: 0, starts }];
    for (const each of changes) parts.push({ first: each.first, starts: this.#given(of, each.values, draw).starts });
    for (let part = 0; part < parts.length && !code; part++) {
      const { first, starts } = parts[part]!;
      take(starts);
      code = instance.dse_web_go(system, first, parts[part + 1]?.first ?? of.steps, of.step);
    }
    if (code) {
      const at = code > 3 ? ` at ${(instance.dse_web_step() * of.step).toPrecision(6)} s` : "";
      ran.problem = textAt(instance, instance.dse_web_said()) || WAYS_TO_FAIL[code]! + at;
      return;
    }
    const table = this.#tables.get(of) ?? emptyTable(of);
    this.#tables.set(of, table);
    const { time, columns } = filled(table, instance, of);
    const found = runProgram(programs[of.program]!, time, columns, constants);
    metrics.forEach((metric, at) => {
      const value = found.metrics[metric.name];
      if (value !== undefined) ran.metrics[at] = shown(value, metric);
    });
    requirements.forEach((name, at) => {
      const mark = found.verdicts[name];
      if (mark === undefined) return;
      ran.marks[at] = mark;
      const [by, bound] = [found.margins[name]!, found.bounds[name]!];
      // What is exactly nothing at a bound of nothing, as the duration of no collision, has not been rounded to it.
      ran.close[at] = Number(Math.abs(by) <= CLOSE * Math.max(1, Math.abs(bound)) && (by !== 0 || bound !== 0));
    });
    if (traces) ran.traces = figures.map((figure) => traceOf(figure, of, time, columns, constants));
    if (isAll) for (const [name, rows] of Object.entries(columns)) ran.columns[name] = everyNth(rows, of.stride);
  }

  /** Start values, and what metrics know, at *values* of the settings. Throws if what is derived from them is none. */
  #given(
    of: System,
    values: Float64Array,
    draw: number,
  ): { starts: Float64Array<ArrayBuffer>; constants: Record<string, number> } {
    const { programs, settings } = this.#document;
    const constants = { ...of.constants };
    const starts = Float64Array.from(of.starts);
    of.settings.forEach(([at, slot], place) => {
      constants[settings[at]!.name] = starts[slot] = values[place]!;
    });
    for (const [slot, byDraw] of of.seeds) starts[slot] = byDraw[draw]!;
    for (const [name, slot, program] of of.derived) {
      const value = evaluate(programs[program]!, constants);
      if (!Number.isFinite(value)) throw new NoRun(`${name} is derived from this point as ${value}`);
      constants[name] = starts[slot] = value;
    }
    return { starts, constants };
  }
}

/** Nothing was simulated. */
class NoRun extends Error {}

function instantiated(module: WebAssembly.Module): Exports {
  // There are no files and no streams: whoever prints is told so, and whoever ends the process ends the run.
  const functions = WebAssembly.Module.imports(module).map(({ name }): [string, (...given: unknown[]) => number] => [
    name,
    () => {
      if (name === "proc_exit") throw new Error("it ended the process");
      return BAD_DESCRIPTOR;
    },
  ]);
  const imports = { wasi_snapshot_preview1: Object.fromEntries(functions) };
  const exports = new WebAssembly.Instance(module, imports).exports as unknown as Exports;
  exports._initialize?.();
  return exports;
}

const BAD_DESCRIPTOR = 8;

function textAt({ memory }: Exports, place: number): string {
  const bytes = new Uint8Array(memory.buffer, place);
  return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
}

interface Table {
  time: Float64Array;
  columns: Record<string, Float64Array>;
}

function emptyTable({ columns, steps, step }: System): Table {
  const time = new Float64Array(steps + 1);
  for (let row = 0; row <= steps; row++) time[row] = row * step;
  return { time, columns: Object.fromEntries(columns.map((name) => [name, new Float64Array(steps + 1)])) };
}

/** *table* with the rows of the last run. */
function filled(table: Table, { memory, dse_web_rows }: Exports, { columns, steps }: System): Table {
  const wide = columns.length;
  const rows = new Float64Array(memory.buffer, dse_web_rows(), (steps + 1) * wide);
  columns.forEach((name, column) => {
    const values = table.columns[name]!;
    for (let row = 0, at = column; row <= steps; row++, at += wide) values[row] = rows[at]!;
  });
  return table;
}

function everyNth(rows: Float64Array, stride: number): Float64Array {
  return Float64Array.from({ length: Math.ceil(rows.length / stride) }, (_, row) => rows[row * stride]!);
}

function traceOf(
  figure: SimulatedFigure,
  { stride }: System,
  time: Float64Array,
  columns: Record<string, Float64Array>,
  constants: Record<string, number>,
): Trace {
  const kept = (rows: Float64Array): Float64Array => everyNth(rows, stride);
  const drawn = (rows: Float64Array | undefined): Float64Array | null =>
    rows ? kept(rows).map((value) => shown(value, figure)) : null;
  const times = kept(time);
  const target = constants[figure.target];
  const flat = target === undefined ? null : new Float64Array(times.length).fill(shown(target, figure));
  return {
    time: times,
    values: drawn(columns[figure.current]) ?? new Float64Array(times.length).fill(NaN),
    targets: figure.target ? (drawn(columns[figure.target]) ?? flat) : null,
  };
}
