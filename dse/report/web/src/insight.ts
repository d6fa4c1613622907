// What was asked and what the runs tell, as dse/report/content/insight.py has it: the fields are called the same.
import { shortened } from "./format";
import type { Numbers } from "./packing";

const MOST_TEXT = 1200;
const MOST_LABEL = 40;

/** Value, low, high; null where there is no interval, or no value. */
export type Estimate = [number | null, number | null, number | null];

export interface Asked {
  sentences: string[];
  roles: string[];
  spreads: string[];
  expressions: string[];
  exercised: string[];
  constants: [string, number][];
  differing: number;
  unfinished: number;
}

export interface Told {
  plane: number[];
  topic: string;
  text: string;
}

export interface Range {
  variable: number;
  low: number;
  high: number;
}

export interface Box {
  plane: number[];
  text: string;
  density: Estimate;
  coverage: number;
  checked: number;
  ranges: Range[];
  choices: string;
}

export interface Centre {
  plane: number[];
  /** Numbers of runs, not their positions. */
  run: number;
  limit: number;
  margin: number;
  around: number;
  share: Estimate;
  ranges: Range[];
}

export interface FactorAxis {
  title: string;
  unit: string;
  /** -1 for a choice. */
  variable: number;
  /** At even places from 0 to 1. */
  values: number[];
  levels: string[];
  /** The title, and the levels, as there is room for them. */
  label: string;
  /** It is no choice. */
  is_condition: boolean;
  labels: string[];
}

export interface Profile {
  power: number;
  error: number;
  explained: number;
  runs: number;
  centres: number;
  weights: Float32Array;
}

export interface Response {
  metric: number;
  bars: { factor: number; share: Estimate }[];
  effects: { factor: number; places: number[]; means: Estimate[] }[];
  profile: Profile | null;
  withheld: string[];
  together: Together | null;
}

/** What each factor has to do with, what it does together with others included, and what depends on two of them. */
export interface Together {
  source: string;
  totals: { factor: number; share: Estimate }[];
  pairs: { one: number; other: number; share: Estimate }[];
}

export interface Part {
  plane: number[];
  factors: FactorAxis[];
  runs: number;
  apart: number;
  centres: Float32Array[];
  responses: Response[];
}

export interface ChanceMap {
  plane: [number, number];
  configuration: number;
  requirement: number;
  size: number;
  /** Percents, x fastest. */
  passing: Uint8Array;
  misjudged: Uint8Array;
  uncertain: number;
  held: [number, number][];
  used: number;
  runs: number;
  conditions: number;
}

/** The plane through the robust centre, of all requirements together (-1); an ellipse by places, 0 … 1. */
export interface Around {
  run: number;
  map: ChanceMap;
  outline: [number, number][];
}

export interface Search {
  objectives: string[];
  units: string[];
  picks: { run: number; configuration: number; values: number[] }[];
  knee: number;
  designs: number;
  feasible: number;
  unfinished: number;
  stages: { runs: number; feasible: number; volume: number | null; best: number | null }[];
}

export interface Insight {
  asked: Asked;
  told: Told[];
  boxes: Box[];
  centres: Centre[];
  parts: Part[];
  chances: ChanceMap[];
  around: Around[];
  search: Search | null;
  withheld: string[];
  /** How many runs it is told of; 0 for all. */
  drawn: number;
}

/** The insight of the document, with its arrays in their places; null for a page without one. */
export function readInsight(source: unknown, arrays: Map<string, Numbers>): Insight | null {
  if (!source) return null;
  const insight = filled(source, arrays) as Insight;
  const fitted = (text: string): string => shortened(text, MOST_TEXT);
  return {
    ...insight,
    told: insight.told.map((each) => ({ ...each, text: fitted(each.text) })),
    boxes: insight.boxes.map((each) => ({ ...each, text: fitted(each.text), choices: fitted(each.choices) })),
    withheld: insight.withheld.map(fitted),
    parts: insight.parts.map((part) => ({
      ...part,
      factors: part.factors.map((factor) => ({
        ...factor,
        label: shortened(factor.title, MOST_LABEL) + (factor.is_condition ? " (condition)" : ""),
        labels: factor.levels.map((level) => shortened(level, MOST_LABEL)),
      })),
    })),
  };
}

function filled(value: unknown, arrays: Map<string, Numbers>): unknown {
  if (Array.isArray(value)) return value.map((each) => filled(each, arrays));
  if (typeof value !== "object" || value === null) return value;
  const { array } = value as { array?: string };
  if (typeof array === "string") return arrays.get(array);
  return Object.fromEntries(Object.entries(value).map(([key, each]) => [key, filled(each, arrays)]));
}
