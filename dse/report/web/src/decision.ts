// Which of two designs is ahead, and what would have to change, as dse/analysis/decision.py has it: both are tested with
// tests/pair_cases.json.
import { groupingOf } from "./grouping";
import { type Counts, counted, type Interval, leading, mean, NORMAL } from "./pairs";
import type { Study, Variable } from "./study";
import { FAIL, FAILED, type Judgement, margin, PASS, type Threshold } from "./verdicts";

export type Ahead = 1 | 0 | -1;

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

export interface Aim {
  title: string;
  unit: string;
  text: (value: number) => string;
  /** Of a design. */
  value: (design: number) => number;
  maximize: boolean;
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
  first: number,
  second: number,
): Decision {
  const used = study.requirements.map((_, index) => index).filter((index) => !thresholds[index]!.off);
  const [one, other] = [first, second].map((design) => sideOf(study, thresholds, each, used, design)) as [Side, Side];
  const missed: [number, number] = [one.missed, other.missed];
  const objectives = aims.map((aim): [number, number] => [aim.value(first), aim.value(second)]);
  const signed = objectives.map(([a, b], index): [number, number] => (aims[index]!.maximize ? [-a, -b] : [a, b]));
  const tie = betterInAll(signed);
  const paired = (runs: Int32Array, others: Int32Array): Case[] => pairsOf(study, thresholds, each, used, runs, others);
  const cases = paired(one.runs, other.runs);
  const found = (variable: number): [number, Case][] =>
    study.variables[variable]!.role === "design"
      ? siblings(study, variable, first, second, paired)
      : cases.map((entry) => [study.variables[variable]!.values[entry.runs[0]]!, entry]);
  return {
    missed,
    judged: [one.judged, other.judged],
    ahead: byVerdicts(missed, tie),
    objectives,
    cases,
    leading: study.requirements.map((_, index) => {
      const own = cases.filter(({ requirement, counts }) => requirement === index && isRandom(counts));
      return own.length ? leading(own.map(({ counts }) => counts)) : null;
    }),
    bounds: used.flatMap((index) =>
      boundChanges(one.margins[index]!, other.margins[index]!, missed, tie).map(([shift, ahead]) => ({
        requirement: index,
        shift,
        ahead,
      })),
    ),
    changes: (one.missed === other.missed ? objectiveChanges(signed) : []).map(([objective, change, ahead]) => ({
      objective,
      change: aims[objective]!.maximize ? -change : change,
      ahead,
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

export function byVerdicts([first, second]: [number, number], tie: Ahead): Ahead {
  return first === second ? tie : first < second ? 1 : -1;
}

/** Who is better in one of the values of both, to be small, and worse in none. */
export function betterInAll(values: [number, number][]): Ahead {
  const signs = new Set(values.map(([a, b]) => Math.sign(b - a)).filter((sign) => sign));
  return signs.size === 1 ? ([...signs][0] as Ahead) : 0;
}

/** By how much a bound must be moved for another design to be ahead, and which; the looser one first. A bound that
 * neither meets anywhere is no answer. */
export function boundChanges(
  first: number[],
  second: number[],
  missed: [number, number],
  tie: Ahead,
): [number, Ahead][] {
  const margins = [first, second].map((own) => own.map((each) => (Number.isNaN(each) ? -Infinity : each)));
  const others = margins.map((own, side) => missed[side]! - own.filter((each) => each < 0).length);
  const now = byVerdicts(missed, tie);
  const at = [...new Set(margins.flat())].filter(Number.isFinite).sort((a, b) => a - b);
  const change = (shifts: number[], fails: (each: number, shift: number) => boolean): [number, Ahead][] => {
    for (const shift of shifts) {
      const then = margins.map((own, side) => others[side]! + own.filter((each) => fails(each, shift)).length);
      if (margins.flat().every((each) => fails(each, shift))) break;
      const ahead = byVerdicts(then as [number, number], tie);
      if (ahead !== now) return [[shift, ahead]];
    }
    return [];
  };
  return [
    ...change(at.filter((each) => each < 0).reverse(), (each, shift) => each < shift),
    ...change(
      at.filter((each) => each >= 0),
      (each, shift) => each <= shift,
    ),
  ];
}

/** Which of the values of both alone alters who is ahead: its number, by how much, and who is ahead then. */
export function objectiveChanges(values: [number, number][]): [number, number, Ahead][] {
  const now = betterInAll(values);
  return values.flatMap(([a, b], index): [number, number, Ahead][] => {
    if (Number.isNaN(b - a) || a === b) return [];
    const others = values.filter((_, place) => place !== index);
    if (others.every(([one, other]) => one === other)) return [[index, b - a, -now as Ahead]];
    const rest = betterInAll(others);
    return rest ? [[index, b - a, now ? 0 : rest]] : [];
  });
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

interface Side {
  runs: Int32Array;
  missed: number;
  judged: number;
  margins: number[][];
}

function sideOf(study: Study, thresholds: Threshold[], each: Uint8Array[], used: number[], design: number): Side {
  const { rows, start } = groupingOf(study);
  const runs = rows.subarray(start[design]!, start[design + 1]!);
  const side: Side = { runs, missed: 0, judged: 0, margins: study.requirements.map(() => []) };
  for (const index of used) {
    const { values } = study.metrics[study.requirements[index]!.metric]!;
    let [met, missed] = [0, 0];
    for (const run of runs) {
      const mark = each[index]![run];
      if (mark === PASS) met++;
      else if (mark === FAIL || mark === FAILED) missed++;
      if (mark === PASS || mark === FAIL) side.margins[index]!.push(margin(values[run]!, thresholds[index]!));
    }
    // What no run exercises is not met.
    side.missed += missed || (met ? 0 : 1);
    side.judged += met + missed || 1;
  }
  return side;
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
