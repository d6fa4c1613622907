// What a page that simulates was given: a module, and what to do with it. See dse/api/studies/page_simulation.py.
import type { MetricProgram } from "../metrics/program";
import { inflate } from "../packing";

/** Shown = (SI - offset) / factor. */
interface Scaled {
  factor: number;
  offset: number;
}

export interface Setting extends Scaled {
  /** `part.parameter` */
  name: string;
  title: string;
  unit: string;
  kind: "real" | "integer" | "boolean" | "enumeration";
  items: string[];
  /** In SI; null where there is no bound. */
  low: number | null;
  high: number | null;
  /** Whether it may be changed during a run. */
  tunable: boolean;
}

export interface SimulatedFigure extends Scaled {
  name: string;
  title: string;
  unit: string;
  /** A column, and a column, a parameter or "". */
  current: string;
  target: string;
}

/** A configuration on a bench; all values are SI, a slot is a place among `starts`. */
export interface System {
  configuration: number;
  bench: number;
  steps: number;
  step: number;
  stop: number;
  /** Every how many rows a waveform is kept. */
  stride: number;
  starts: number[];
  columns: string[];
  /** Place among the settings of the document, slot, and value on the bench. */
  settings: [number, number, number][];
  constants: Record<string, number>;
  derived: [name: string, slot: number, program: number][];
  seeds: [slot: number, byDraw: number[]][];
  program: number;
}

export interface SimulationDocument {
  study: string;
  benches: string[];
  draws: number;
  programs: MetricProgram[];
  settings: Setting[];
  /** Their names, and what they are called. */
  requirements: string[];
  titles: string[];
  /** What the study varies, with ranges in their units. */
  variables: ({ name: string; title: string; unit: string; low: number; high: number } & Scaled)[];
  metrics: ({ name: string } & Scaled)[];
  figures: SimulatedFigure[];
  systems: System[];
}

export const shown = (si: number, { factor, offset }: Scaled): number => (si - offset) / factor;

const given = (id: string): string => document.getElementById(id)?.textContent ?? "";

/** Whether the page can simulate. */
export function canSimulate(): boolean {
  return document.getElementById("simulation") !== null;
}

export async function readSimulation(): Promise<{
  document: SimulationDocument;
  module: WebAssembly.Module;
  worker: string;
}> {
  const [text, module] = await Promise.all([inflate(given("simulation")), inflate(given("module"))]);
  return {
    document: JSON.parse(new TextDecoder().decode(text)) as SimulationDocument,
    module: await WebAssembly.compile(module),
    worker: given("worker"),
  };
}
