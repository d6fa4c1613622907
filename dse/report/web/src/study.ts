// The study as the page sees it: typed columns, one value per run, in the units shown.
import { readCharted, type Charted } from "./chart";
import { columnText } from "./format";
import { unpack, type Entry, type Numbers } from "./packing";

export interface Column {
  name: string;
  title: string;
  unit: string;
  values: Float64Array;
  text: (value: number) => string;
}

export interface Metric extends Column {
  /** Error bars, NaN where none can be measured; null if the study made none. */
  error: Float64Array | null;
}

export interface Variable extends Column {
  low: number;
  high: number;
  nominal: number;
  /** How many values a grid has of it when all its runs are made; 0 if it is on none. */
  levels: number;
  // Places of the configurations that do not have it.
  lack: number[];
}

export interface Requirement {
  name: string;
  title: string;
  metric: number;
  atMost: number | null;
  atLeast: number | null;
  exercised: Uint8Array;
  /** Finer numerics may change the verdict, whatever the margin; null if that was not looked at. */
  unsettled: Uint8Array | null;
}

export interface Configuration {
  id: string;
  choices: [string, string][];
  properties: [string, string][];
  radial: Radial | null;
}

/** Interpolation weights made by dse/report/interpolation/radial.py; `weights` holds one row of `centres.length + 1` per field.
 * Metrics come first, each as asinh((value - middle) / spread). */
export interface Radial {
  centres: Int32Array;
  weights: Float32Array;
  middle: Float64Array;
  spread: Float64Array;
}

export interface Figure {
  name: string;
  title: string;
  unit: string;
  current: string;
  target: string;
  shape: "none" | "constant" | "waveform";
  time: Float64Array;
  row: Map<number, number>;
  constants: Float64Array | null;
  ranges: Record<"current" | "target", { low: Float64Array; high: Float64Array } | null>;
}

export type Sampler = "full_factorial" | "sliced" | "scattered";

export interface Study {
  title: string;
  sampler: Sampler;
  size: number;
  mostCentres: number;
  number: Int32Array;
  configuration: Int32Array;
  done: Uint8Array;
  /** Which runs have error bars; null if all or none have. */
  checked: Uint8Array | null;
  problems: Map<number, string>;
  variables: Variable[];
  metrics: Metric[];
  requirements: Requirement[];
  configurations: Configuration[];
  slices: number[][];
  figures: Figure[];
  charted: Charted[];
  facts: [string, string][];
  waveforms: () => Promise<Map<string, Numbers>>;
}

interface Document {
  title: string;
  sampler: Sampler;
  runs: number;
  mostCentres: number;
  variables: { name: string; title: string; unit: string; low: number; high: number; nominal: number; levels: number; lack: number[] }[];
  metrics: { name: string; title: string; unit: string; checked: boolean }[];
  requirements: { name: string; title: string; metric: number; atMost: number | null; atLeast: number | null }[];
  configurations: { id: string; choices: [string, string][]; properties: [string, string][] }[];
  slices: number[][];
  problems: [number, string][];
  figures: { name: string; title: string; unit: string; current: string; target: string; shape: Figure["shape"] }[];
  charted: Charted[];
  facts: [string, string][];
  radial?: boolean[];
  columns: Entry[];
  waveforms: Entry[];
}

export async function readStudy(): Promise<Study> {
  const source = JSON.parse(block("document")) as Document;
  const arrays = await unpack(source.columns, block("columns"));
  const floats = (name: string): Float64Array => arrays.get(name) as Float64Array;
  const integers = (name: string): Int32Array => arrays.get(name) as Int32Array;
  const flags = (name: string): Uint8Array => arrays.get(name) as Uint8Array;
  const column = (name: string): Pick<Column, "values" | "text"> => ({
    values: floats(name),
    text: columnText(floats(name)),
  });
  const range = (name: string): { low: Float64Array; high: Float64Array } | null =>
    arrays.has(`${name}.low`) ? { low: floats(`${name}.low`), high: floats(`${name}.high`) } : null;
  let waveforms: Promise<Map<string, Numbers>> | undefined;
  return {
    title: source.title,
    sampler: source.sampler,
    size: source.runs,
    mostCentres: source.mostCentres,
    number: integers("number"),
    configuration: integers("configuration"),
    done: flags("done"),
    checked: arrays.has("checked") ? flags("checked") : null,
    problems: new Map(source.problems),
    variables: source.variables.map((variable, i) => ({ ...variable, ...column(`variable.${i}`) })),
    metrics: source.metrics.map((metric, i) => ({
      ...metric,
      ...column(`metric.${i}`),
      error: metric.checked ? floats(`error.${i}`) : null,
    })),
    requirements: source.requirements.map((requirement, i) => ({
      ...requirement,
      exercised: flags(`exercised.${i}`),
      unsettled: arrays.has(`unsettled.${i}`) ? flags(`unsettled.${i}`) : null,
    })),
    configurations: source.configurations.map((configuration, i) => ({
      ...configuration,
      radial: source.radial?.[i]
        ? {
            centres: integers(`radial.${i}.centres`),
            weights: arrays.get(`radial.${i}.weights`) as Float32Array,
            middle: floats(`radial.${i}.middle`),
            spread: floats(`radial.${i}.spread`),
          }
        : null,
    })),
    slices: source.slices,
    figures: source.figures.map((figure, i) => ({
      ...figure,
      time: floats(`figure.${i}.time`),
      row: new Map(Array.from(integers(`figure.${i}.kept`), (number, row) => [number, row])),
      constants: figure.shape === "constant" ? floats(`figure.${i}.target`) : null,
      ranges: { current: range(`figure.${i}.current`), target: range(`figure.${i}.target`) },
    })),
    charted: readCharted(source.charted, arrays),
    facts: source.facts,
    waveforms: () => (waveforms ??= unpack(source.waveforms, block("waveforms"))),
  };
}

export function axisLabel(column: { title: string; unit: string }): string {
  return `${column.title} [${column.unit || "\u2013"}]`;
}

function block(id: string): string {
  return document.getElementById(id)!.textContent!;
}
