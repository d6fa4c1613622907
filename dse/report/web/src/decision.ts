// Which of two designs is ahead, and what would have to change, as dse/analysis/decision.py has it: both are tested with
// tests/pair_cases.json.
import { groupingOf } from "./grouping";
import { type Ahead, type Aim, aheadBy, type DesignOrder } from "./order";
import { type Counts, counted, type Interval, leading, mean, NORMAL } from "./pairs";
import type { Study, Variable } from "./study";
import { FAIL, isDoubtful, type Judgement, margin, PASS, type Threshold } from "./verdicts";

/** A requirement in a case: the runs of both designs, with the margins of the draws that decide. */
export interface Case {
  requirement: number;
  runs: [number, number];
  margins: [number, number];
  counts: Counts;
}

export interface Effect {
  variable: number;
  requirement: number;
  values: number[];
  levels: Interval[];
  change: Interval;
  isLine: boolean;
}

export interface Decision {
  missed: [number, number];
  judged: [number, number];
  ahead: Ahead;
  /** The column of the order that decides, -1 if none does. */
  by: number;
  /** In the order of `aimsOf`. */
  objectives: [number, number][];
  cases: Case[];
  /** By requirement; null where nothing is random. */
  leading: (Interval | null)[];
  /** By how much a bound must be moved, tighter if positive, for another one to be ahead. */
  bounds: { requirement: number; shift: number; ahead: Ahead }[];
  changes: { objective: number; change: number; ahead: Ahead }[];
  effects: Effect[];
}

/** Whether single draws are in the page, wherever points have several. */
export function hasDraws(study: Study): boolean {
  return study.drawn !== null || !study.requirements.some(({ draws }) => draws);
}

/** *first* and *second* are designs at *thresholds*, *judgement* is that of the runs. */
export function decide(
  study: Study,
  thresholds: Threshold[],
  { each }: Judgement,
  aims: Aim[],
  order: DesignOrder,
  first: number,
  second: number,
): Decision {
  const used = study.requirements.map((_, index) => index).filter((index) => !thresholds[index]!.off);
  const { rows, start } = groupingOf(study);
  const [one, other] = [first, second].map((design) => rows.subarray(start[design]!, start[design + 1]!)) as [
    Int32Array,
    Int32Array,
  ];
  const keys = [first, second].map((design) => order.keys.map((column) => column[design]!)) as [number[], number[]];
  const [ahead, by] = aheadBy(order.keys, first, second);
  const objectives = aims.map(({ values }): [number, number] => [values[first]!, values[second]!]);
  const paired = (runs: Int32Array, others: Int32Array): Case[] => pairsOf(study, thresholds, each, used, runs, others);
  const cases = paired(one, other);
  const found = (variable: number): [number, Case][] =>
    study.variables[variable]!.role === "design"
      ? siblings(study, variable, first, second, paired)
      : cases.map((entry) => [study.variables[variable]!.values[entry.runs[0]]!, entry]);
  const total = (what: "judged" | "certain" | "doubtful", design: number): number =>
    order.classes.reduce((sum, counts) => sum + counts[what][design]!, 0);
  const last = 1 + 2 * order.classes.length;
  const margins = (index: number, runs: Int32Array): Missable[] => marginsOf(study, thresholds, each, index, runs);
  return {
    missed: [first, second].map((design) => total("certain", design) + total("doubtful", design)) as [number, number],
    judged: [total("judged", first), total("judged", second)],
    ahead,
    by,
    objectives,
    cases,
    leading: study.requirements.map((_, index) => {
      const own = cases.filter(({ requirement, counts }) => requirement === index && isRandom(counts));
      return own.length ? leading(own.map(({ counts }) => counts)) : null;
    }),
    bounds: used.flatMap((index) => {
      const column = 1 + 2 * order.classes.findIndex(({ level }) => level === study.requirements[index]!.level);
      return boundChanges(margins(index, one), margins(index, other), keys, column).map(([shift, then]) => ({
        requirement: index,
        shift,
        ahead: then,
      }));
    }),
    changes: (ahead && by < last
      ? []
      : objectiveChanges(aims.map((_, index) => [keys[0][last + index]!, keys[1][last + index]!]))
    ).map(([objective, change, then]) => ({
      objective,
      change: aims[objective]!.maximize ? -change : change,
      ahead: then,
    })),
    effects: study.variables.flatMap((_, variable) => {
      const pairs = found(variable);
      return used.flatMap((requirement): Effect[] => {
        const own = pairs.filter(([, entry]) => entry.requirement === requirement);
        const effect = effectOf(own.map(([value, { counts }]) => [value, counts]));
        return effect ? [{ variable, requirement, ...effect }] : [];
      });
    }),
  };
}

export function isRandom({ difference }: Counts): boolean {
  return difference.low < difference.high;
}

export function isCertain({ low, high }: Interval): boolean {
  return low > 0 || high < 0;
}

/** A margin, and whether it is missed but doubtful. */
export type Missable = [number, boolean];

/** By how much a bound must be moved for another design to be ahead, and which; the looser one first. A bound that
 * neither meets anywhere is no answer. In the keys, *column* counts misses for certain, and the next one doubtful ones. */
export function boundChanges(
  first: Missable[],
  second: Missable[],
  keys: [number[], number[]],
  column: number,
): [number, Ahead][] {
  const sides = [first, second].map((own) =>
    own.map(([margin, doubtful]): Missable => [Number.isNaN(margin) ? -Infinity : margin, doubtful]),
  );
  const all = sides.flat().map(([margin]) => margin);
  const aheadWith = (fails: (margin: number) => boolean): Ahead => {
    const moved = keys.map((key, side) => {
      const change = (doubtful: boolean): number =>
        sides[side]!.reduce(
          (sum, [by, state]) => (state === doubtful ? sum + Number(fails(by)) - Number(by < 0) : sum),
          0,
        );
      const now = [...key];
      now[column]! += change(false);
      now[column + 1]! += change(true);
      return now;
    });
    return aheadBy(
      moved[0]!.map((value, place) => [value, moved[1]![place]!]),
      0,
      1,
    )[0];
  };
  const now = aheadWith((by) => by < 0);
  const at = [...new Set(all)].filter(Number.isFinite).sort((a, b) => a - b);
  const change = (shifts: number[], fails: (by: number, shift: number) => boolean): [number, Ahead][] => {
    for (const shift of shifts) {
      if (all.every((by) => fails(by, shift))) break;
      const ahead = aheadWith((by) => fails(by, shift));
      if (ahead !== now) return [[shift, ahead]];
    }
    return [];
  };
  return [
    ...change(at.filter((by) => by < 0).reverse(), (by, shift) => by < shift),
    ...change(
      at.filter((by) => by >= 0),
      (by, shift) => by <= shift,
    ),
  ];
}

/** Which of the values of both, to be small, alters who is ahead: its number, by how much, and who is ahead then. Only
 * the first in which they differ does. */
export function objectiveChanges(values: [number, number][]): [number, number, Ahead][] {
  const index = values.findIndex(([a, b]) => a !== b);
  const [a, b] = values[index] ?? [NaN, NaN];
  return Number.isFinite(b - a) ? [[index, b - a, a < b ? -1 : 1]] : [];
}

const MOST_LEVELS = 12;
const ROUNDING = 1e-9;

/** Mean differences of margins by values of a variable; null of fewer than two values. */
export function effectOf(
  pairs: [number, Pick<Counts, "margin" | "error">][],
): Pick<Effect, "values" | "levels" | "change" | "isLine"> | null {
  const sound = pairs.filter(([, { margin }]) => Number.isFinite(margin));
  const values = [...new Set(sound.map(([value]) => value))].sort((a, b) => a - b);
  if (values.length < 2) return null;
  if (values.length > MOST_LEVELS) return line(sound.map(([value, { margin }]) => [value, margin]));
  const there = values.map((value) => sound.filter(([at]) => at === value).map(([, counts]) => counts));
  const means = there.map((own) => mean(own.map(({ margin }) => margin)));
  const errors = there.map((own) => Math.sqrt(own.reduce((sum, { error }) => sum + error ** 2, 0)) / own.length);
  const largest = means.indexOf(Math.max(...means));
  const least = means.indexOf(Math.min(...means));
  const reach = means[largest]! - means[least]!;
  const isRounding = reach <= ROUNDING * Math.max(...means.map(Math.abs));
  return {
    values,
    levels: means.map((value, level) => interval(value, errors[level]!, NORMAL)),
    change: interval(isRounding ? 0 : reach, Math.hypot(errors[largest]!, errors[least]!), NORMAL),
    isLine: false,
  };
}

/** Least squares; what the line leaves is taken for noise. */
function line(points: [number, number][]): Pick<Effect, "values" | "levels" | "change" | "isLine"> {
  const n = points.length;
  const middle = mean(points.map(([x]) => x));
  const height = mean(points.map(([, y]) => y));
  const sum = (of: (x: number, y: number) => number): number =>
    points.reduce((all, [x, y]) => all + of(x - middle, y - height), 0);
  const width = sum((x) => x * x);
  const slope = sum((x, y) => x * y) / width;
  const deviation = Math.sqrt(sum((x, y) => (y - slope * x) ** 2) / (n - 2));
  const factor = student(n - 2);
  const xs = points.map(([x]) => x);
  const ends = [Math.min(...xs), Math.max(...xs)];
  const reach = ends[1]! - ends[0]!;
  return {
    values: ends,
    levels: ends.map((at) =>
      interval(height + slope * (at - middle), deviation * Math.sqrt(1 / n + (at - middle) ** 2 / width), factor),
    ),
    change: interval(slope * reach, (deviation * reach) / Math.sqrt(width), factor),
    isLine: true,
  };
}

/** The 97.5 % quantile of Student's t (Abramowitz and Stegun 26.7.5). */
export function student(freedom: number): number {
  const z = NORMAL;
  return z + (z ** 3 + z) / (4 * freedom) + (5 * z ** 5 + 16 * z ** 3 + 3 * z) / (96 * freedom ** 2);
}

function interval(value: number, error: number, factor: number): Interval {
  return { value, low: value - factor * error, high: value + factor * error };
}

/** Of the runs of a design that are judged. */
function marginsOf(
  study: Study,
  thresholds: Threshold[],
  each: Uint8Array[],
  index: number,
  runs: Int32Array,
): Missable[] {
  const { values } = study.metrics[study.requirements[index]!.metric]!;
  const threshold = thresholds[index]!;
  return Array.from(runs).flatMap((run): Missable[] => {
    const mark = each[index]![run];
    if (mark !== PASS && mark !== FAIL) return [];
    return [[margin(values[run]!, threshold), mark === FAIL && isDoubtful(study, index, run, threshold)]];
  });
}

/** Runs by what is imposed on them. */
function byCase(study: Study, runs: Int32Array): Map<string, number> {
  const given = study.variables.filter(({ role }) => role !== "design");
  return new Map(Array.from(runs, (run) => [given.map(({ values }) => values[run]).join(), run]));
}

function pairsOf(
  study: Study,
  thresholds: Threshold[],
  each: Uint8Array[],
  used: number[],
  runs: Int32Array,
  others: Int32Array,
): Case[] {
  const theirs = byCase(study, others);
  const both = [...byCase(study, runs)].flatMap(([key, run]): [number, number][] => {
    const other = theirs.get(key);
    return other === undefined ? [] : [[run, other]];
  });
  return used.flatMap((requirement) =>
    both.flatMap((pair): Case[] => {
      const threshold = thresholds[requirement]!;
      const drawn = pair.map((run) => drawsOf(study, each, requirement, run, threshold));
      const draws = [...new Set(drawn.flatMap(({ margins }) => [...margins.keys()]))].sort((a, b) => a - b);
      // The only run without noise, whose draw is 0, goes with every draw.
      const [first, second] = drawn.map(({ margins }) => draws.map((draw) => margins.get(draw) ?? margins.get(0)));
      const shared = draws
        .map((_, place) => place)
        .filter((at) => first![at] !== undefined && second![at] !== undefined);
      if (!shared.length) return [];
      const { values } = study.metrics[study.requirements[requirement]!.metric]!;
      return [
        {
          requirement,
          runs: pair,
          margins: pair.map((run) => margin(values[run]!, threshold)) as [number, number],
          counts: counted(
            shared.map((at) => first![at]!),
            shared.map((at) => second![at]!),
            drawn.some(({ random }) => random),
          ),
        },
      ];
    }),
  );
}

const rowsOfDraws = new WeakMap<Study, Map<number, number[]>>();

/** Margins of the draws of a run that are judged, by draw. */
function drawsOf(
  study: Study,
  each: Uint8Array[],
  requirement: number,
  run: number,
  threshold: Threshold,
): { margins: Map<number, number>; random: boolean } {
  const { metric } = study.requirements[requirement]!;
  if (!study.drawn) {
    const isJudged = each[requirement]![run] === PASS || each[requirement]![run] === FAIL;
    const random = study.configurations[study.configuration[run]!]!.noisy;
    const value = study.metrics[metric]!.values[run]!;
    return { margins: new Map(isJudged ? [[random ? 1 : 0, margin(value, threshold)]] : []), random };
  }
  const { row, draw, judged, values } = study.drawn;
  let places = rowsOfDraws.get(study);
  if (!places) {
    places = new Map();
    for (let place = 0; place < row.length; place++) {
      const known = places.get(row[place]!);
      if (known) known.push(place);
      else places.set(row[place]!, [place]);
    }
    rowsOfDraws.set(study, places);
  }
  const own = (places.get(run) ?? []).filter((place) => judged[requirement]![place]);
  const margins = own.map((place): [number, number] => [draw[place]!, margin(values.get(metric)![place]!, threshold)]);
  return { margins: new Map(margins), random: own.some((place) => draw[place]) };
}

/** Both designs with other values of a design variable, if both have the same one: their cases, by its value. */
function siblings(
  study: Study,
  variable: number,
  first: number,
  second: number,
  paired: (runs: Int32Array, others: Int32Array) => Case[],
): [number, Case][] {
  const grouping = groupingOf(study);
  const { values, lack } = study.variables[variable]!;
  const leads = [first, second].map((design) => grouping.first[design]!);
  const has = leads.every((run) => !lack.includes(study.configuration[run]!));
  if (!has || values[leads[0]!] !== values[leads[1]!]) return [];
  const others = study.variables.filter(({ role }, place) => role === "design" && place !== variable);
  const [mine, theirs] = leads.map((lead) => {
    const near = Array.from(grouping.first.keys()).filter((design) =>
      isNear(study, others, lead, grouping.first[design]!),
    );
    return new Map(near.map((design) => [values[grouping.first[design]!]!, design]));
  });
  const runs = (design: number): Int32Array =>
    grouping.rows.subarray(grouping.start[design]!, grouping.start[design + 1]!);
  return [...mine!].flatMap(([value, design]) => {
    const other = theirs!.get(value);
    return other === undefined ? [] : paired(runs(design), runs(other)).map((entry): [number, Case] => [value, entry]);
  });
}

function isNear(study: Study, others: Variable[], one: number, other: number): boolean {
  return (
    study.configuration[one] === study.configuration[other] &&
    others.every(({ values }) => values[one] === values[other])
  );
}
