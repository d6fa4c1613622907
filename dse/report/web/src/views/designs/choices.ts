// What the reader has chosen among designs, and as settings of the page, which stand in its address.
// What stands there may be wrong or made up: what does not fit the study is as it was at the start.
import { columnOf } from "../../columns";
import { groupingOf } from "../../grouping";
import type { Study } from "../../study";
import { designColumns } from "./values";

export interface Criterion {
  column: string;
  maximize: boolean;
  /** 0 … 10. */
  weight: number;
}

/** Plain data: all that is chosen in this view alone. */
export interface Choices {
  /** Share of margin that is asked for. */
  demand: number;
  criteria: readonly Criterion[];
  x: string;
  y: string;
  /** `verdict`, the key of a column, or `place.NAME`. */
  colour: string;
  points: "designs" | "runs";
  /** Designs that are compared, at most MOST_COMPARED. */
  picked: readonly number[];
  sort: { column: string; descending: boolean };
  /** Column of the boxes, and which designs they are over. */
  boxes: string;
  among: "all" | "feasible";
  /** A run at the condition, with the draw, whose waveforms are compared; -1 for the runs that decide. */
  case: number;
}

export const MOST_COMPARED = 5;
export const MOST_DEMAND = 0.5;
export const MOST_WEIGHT = 10;
const MOST_CRITERIA = 20;

type Settings = Readonly<Record<string, string>>;
type Keys = readonly (keyof Choices)[];
const KEYS: Keys = ["demand", "criteria", "x", "y", "colour", "points", "picked", "sort", "boxes", "among", "case"];

/** *settings* with all in *choices* that is not as in *start*. */
export function withChoices(study: Study, settings: Settings, choices: Choices, start: Choices): Settings {
  const others = Object.fromEntries(Object.entries(settings).filter(([key]) => !key.startsWith("designs.")));
  const told = KEYS.map((key): [string, string, string] => [
    `designs.${key}`,
    textOf(study, choices, key),
    textOf(study, start, key),
  ]);
  return {
    ...others,
    ...Object.fromEntries(told.filter(([, now, then]) => now !== then).map(([key, now]) => [key, now || "none"])),
  };
}

/** What *settings* say that fits the study, else what is in *start*; a value that is as in *last* is the very same. */
export function readChoices(study: Study, settings: Settings, start: Choices, last: Choices): Choices {
  const read = Object.fromEntries(
    KEYS.map((key) => {
      const given = settings[`designs.${key}`];
      const value = given === undefined ? start[key] : (valueIn(study, key, given) ?? start[key]);
      return [key, JSON.stringify(value) === JSON.stringify(last[key]) ? last[key] : value];
    }),
  );
  return read as unknown as Choices;
}

function textOf(study: Study, choices: Choices, key: keyof Choices): string {
  switch (key) {
    case "criteria":
      return choices.criteria
        .map(({ column, maximize, weight }) => `${column}:${maximize ? "max" : "min"}:${weight}`)
        .join();
    case "picked":
      return choices.picked.map((design) => study.number[groupingOf(study).first[design]!]).join();
    case "sort":
      return `${choices.sort.descending ? "down" : "up"}:${choices.sort.column}`;
    case "case":
      return choices.case < 0 ? "" : String(study.number[choices.case]);
    default:
      return String(choices[key]);
  }
}

function valueIn(study: Study, key: keyof Choices, text: string): Choices[keyof Choices] | null {
  const runOf = (given: string): number => (/^\d{1,9}$/.test(given) ? study.number.indexOf(Number(given)) : -1);
  const own = designColumns(study).map((column) => column.key);
  switch (key) {
    case "demand":
      return between(text, MOST_DEMAND);
    case "criteria":
      return readCriteria(text, own);
    case "x":
    case "y":
      return columnOf(study, text) ? text : null;
    case "boxes":
      return own.includes(text) ? text : null;
    case "colour":
      return text === "verdict" ||
        own.includes(text) ||
        study.configurations.some(({ choices }) => choices.some(([name]) => `place.${name}` === text))
        ? text
        : null;
    case "points":
      return text === "designs" || text === "runs" ? text : null;
    case "among":
      return text === "all" || text === "feasible" ? text : null;
    case "picked": {
      const runs = text
        .split(",")
        .slice(0, MOST_COMPARED)
        .map(runOf)
        .filter((run) => run >= 0);
      return [...new Set(runs.map((run) => groupingOf(study).of[run]!))];
    }
    case "sort": {
      const [way, ...column] = text.split(":");
      return way === "up" || way === "down" ? { column: column.join(":"), descending: way === "down" } : null;
    }
    case "case":
      return runOf(text);
  }
}

function readCriteria(text: string, known: string[]): Criterion[] | null {
  const found = new Map<string, Criterion>();
  for (const entry of text.split(",").slice(0, MOST_CRITERIA)) {
    const [column, way, given] = entry.split(":");
    const weight = between(given, MOST_WEIGHT);
    if (column && known.includes(column) && weight !== null)
      found.set(column, { column, maximize: way === "max", weight });
  }
  return found.size || text === "none" ? [...found.values()] : null;
}

function between(text: string | undefined, most: number): number | null {
  const value = Number(text);
  return text && value >= 0 && value <= most ? value : null;
}
