// The study as the page sees it: typed columns, one value per run, in the units shown.
import { type Charted, readCharted } from "./chart";
import { columnText, number, shortened, straight, withUnit } from "./format";
import { type Insight, readInsight } from "./insight";
import { type Notes, type Retried, readNotes, readRetried } from "./notes";
import { type Entry, type Numbers, unpack } from "./packing";

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
  /** What the values 0, 1, … are called; none where they are quantities. */
  labels: string[];
  /** Its values, evenly spaced on axes, if nothing is known between them. */
  apart: number[];
  /** Sampled on a logarithmic scale, which its axes have as well. */
  log: boolean;
  names?: string[];
  role: "design" | "condition" | "uncertain";
}

/** A property: `values` holds one number per configuration, not per run, NaN where it has none. */
export interface Property extends Column {
  /** Whether its unit is a currency. */
  isPrice: boolean;
}

export interface Objective {
  /** Key of a column. */
  column: string;
  maximize: boolean;
}

/** Where parts stand that hang together alike: path, left edge, middle and width of each, and linked pairs. */
export interface Picture {
  parts: [string, number, number, number][];
  links: [number, number][];
  width: number;
  height: number;
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
  /** By run, at the study's own bounds: how many draws met it, of how many, and between which rates that leaves it. */
  draws: { met: Float32Array; judged: Float32Array; low: Float32Array; high: Float32Array } | null;
  /** The runs that are on one of its benches; null if all are. */
  applies: Uint8Array | null;
  /** The share of the draws that is to meet it. */
  metIn: number;
  /** The place of its severity among those of the study, 0 for the highest. */
  level: number;
  /** What its author says of it, by name. */
  origin: [string, string][];
}

/** Which hosts each function is allocated to, and for each load its amounts beside the capacities of the hosts. */
export interface Allocation {
  place: string;
  hosts: string[];
  functions: string[];
  on: Record<string, string[]>;
  loads: {
    load: string;
    capacity: string;
    unit: string;
    loads: Record<string, number>;
    capacities: Record<string, number>;
  }[];
}

export interface Configuration {
  id: string;
  choices: [string, string][];
  /** As text with units. */
  properties: [string, string][];
  /** Its place among the pictures, -1 for none, and what stands in each part. */
  picture: number;
  parts: string[];
  radial: Radial | null;
  /** Whether its runs depend on a draw. */
  noisy: boolean;
  allocations: Allocation[];
}

/** The single runs behind those that stand for several draws: which one each belongs to; the draw, 0 for no noise;
 * whether there is a verdict, by requirement; values, by metric. */
export interface Drawn {
  row: Int32Array;
  draw: Int32Array;
  judged: Uint8Array[];
  values: Map<number, Float64Array>;
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
  properties: Property[];
  /** What objectives compute from metrics and properties, one value per run. */
  composites: Column[];
  objectives: Objective[];
  pictures: Picture[];
  slices: number[][];
  figures: Figure[];
  charted: Charted[];
  facts: [string, string][];
  /** What was asked and what the runs tell; null for a page that was made without. */
  insight: Insight | null;
  /** What of the study could not be read. */
  missing: string[];
  notes: Notes | null;
  retried: Retried[];
  /** Whose runs can be seen in three dimensions, and the numbers of those that lie beside this page; null if none can. */
  scenes: { study: string; made: ReadonlySet<number> } | null;
  /** null where each run is one draw, or where there are too many for a page. */
  drawn: Drawn | null;
  waveforms: () => Promise<Map<string, Numbers>>;
}

export const MOST_TITLE = 120;
const MOST_UNIT = 20;

interface Document {
  title: string;
  sampler: Sampler;
  runs: number;
  mostCentres: number;
  variables: {
    name: string;
    title: string;
    unit: string;
    low: number;
    high: number;
    nominal: number;
    levels: number;
    lack: number[];
    role: Variable["role"];
    labels: string[];
    apart: number[];
    log: boolean;
  }[];
  metrics: { name: string; title: string; unit: string; checked: boolean }[];
  requirements: Pick<Requirement, "name" | "title" | "metric" | "atMost" | "atLeast" | "metIn" | "level" | "origin">[];
  configurations: Pick<Configuration, "id" | "choices" | "noisy" | "allocations">[];
  properties: { name: string; title: string; unit: string; isPrice: boolean }[];
  composites: { name: string; title: string; unit: string }[];
  objectives: Objective[];
  pictures: Picture[];
  pictureOf: number[];
  components: string[];
  partsOf: number[][];
  slices: number[][];
  problems: [number, string][];
  figures: { name: string; title: string; unit: string; current: string; target: string; shape: Figure["shape"] }[];
  charted: Charted[];
  facts: [string, string][];
  radial?: boolean[];
  insight?: unknown;
  missing?: string[];
  notes?: Notes | null;
  retried?: Retried[];
  scenes?: { study: string; made: number[] };
  drawn: number[] | null;
  columns: Entry[];
  waveforms: Entry[];
}

export async function readStudy(): Promise<Study> {
  const source = JSON.parse(block("document"), (_, value: unknown) =>
    typeof value === "string" ? straight(value) : value,
  ) as Document;
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
  const properties = source.properties.map((property, i) => ({ ...property, ...column(`property.${i}`) }));
  let waveforms: Promise<Map<string, Numbers>> | undefined;
  return {
    title: shortened(source.title, MOST_TITLE),
    sampler: source.sampler,
    size: source.runs,
    mostCentres: source.mostCentres,
    number: integers("number"),
    configuration: integers("configuration"),
    done: flags("done"),
    checked: arrays.has("checked") ? flags("checked") : null,
    problems: new Map(source.problems),
    variables: source.variables.map((variable, i) => ({
      ...variable,
      ...named(variable),
      ...column(`variable.${i}`),
      ...labelled(variable.labels),
    })),
    metrics: source.metrics.map((metric, i) => ({
      ...metric,
      ...named(metric),
      ...column(`metric.${i}`),
      error: metric.checked ? floats(`error.${i}`) : null,
    })),
    requirements: source.requirements.map((requirement, i) => ({
      ...requirement,
      title: shortened(requirement.title, MOST_TITLE),
      exercised: flags(`exercised.${i}`),
      unsettled: arrays.has(`unsettled.${i}`) ? flags(`unsettled.${i}`) : null,
      applies: arrays.has(`applies.${i}`) ? flags(`applies.${i}`) : null,
      draws: drawsOf(arrays.get(`draws.${i}`) as Float32Array | undefined),
    })),
    configurations: source.configurations.map((configuration, i) => ({
      ...configuration,
      properties: properties
        .filter(({ values }) => !Number.isNaN(values[i]))
        .map(({ name, unit, values }): [string, string] => [name, withUnit(number(values[i]!, 6), unit)]),
      picture: source.pictureOf[i]!,
      parts: source.partsOf[i]!.map((code) => source.components[code]!),
      radial: source.radial?.[i]
        ? {
            centres: integers(`radial.${i}.centres`),
            weights: arrays.get(`radial.${i}.weights`) as Float32Array,
            middle: floats(`radial.${i}.middle`),
            spread: floats(`radial.${i}.spread`),
          }
        : null,
    })),
    properties,
    composites: source.composites.map((composite, i) => ({ ...composite, ...column(`composite.${i}`) })),
    objectives: source.objectives,
    pictures: source.pictures,
    slices: source.slices,
    figures: source.figures.map((figure, i) => ({
      ...figure,
      ...named(figure),
      time: floats(`figure.${i}.time`),
      row: new Map(Array.from(integers(`figure.${i}.kept`), (number, row) => [number, row])),
      constants: figure.shape === "constant" ? floats(`figure.${i}.target`) : null,
      ranges: { current: range(`figure.${i}.current`), target: range(`figure.${i}.target`) },
    })),
    charted: readCharted(source.charted, arrays),
    facts: source.facts,
    insight: readInsight(source.insight, arrays),
    missing: source.missing ?? [],
    notes: readNotes(source.notes),
    retried: readRetried(source.retried),
    scenes: source.scenes ? { study: source.scenes.study, made: new Set(source.scenes.made) } : null,
    drawn: source.drawn && {
      row: integers("drawn.row"),
      draw: integers("drawn.draw"),
      judged: source.requirements.map((_, i) => flags(`drawn.judged.${i}`)),
      values: new Map(source.drawn.map((metric) => [metric, floats(`drawn.value.${metric}`)])),
    },
    waveforms: () => (waveforms ??= unpack(source.waveforms, block("waveforms"))),
  };
}

/** What a row of the study is: a run, or a point that was simulated with several draws. */
export function rowNoun({ requirements }: Pick<Study, "requirements">): "run" | "point" {
  return requirements.some(({ draws }) => draws) ? "point" : "run";
}

function labelled(labels: string[]): (Pick<Column, "text"> & { names: string[] }) | null {
  return labels.length ? { text: (value) => labels[value] ?? number(value), names: labels } : null;
}

export function axisLabel(column: { title: string; unit: string }): string {
  return `${column.title} [${column.unit || "\u2013"}]`;
}

// A title of ten thousand letters, or one that turns the text around it, would break every panel it stands in.
function named({ title, unit }: { title: string; unit: string }): { title: string; unit: string } {
  return { title: shortened(title, MOST_TITLE), unit: shortened(unit, MOST_UNIT) };
}

function block(id: string): string {
  return document.getElementById(id)!.textContent!;
}

/** Four rows, one after the other. */
function drawsOf(rows: Float32Array | undefined): Requirement["draws"] {
  if (!rows) return null;
  const size = rows.length / 4;
  const [met, judged, low, high] = [0, 1, 2, 3].map((row) => rows.subarray(row * size, (row + 1) * size));
  return { met: met!, judged: judged!, low: low!, high: high! };
}
