// The order of designs: which of them to take, as dse/analysis/order.py has it; both are tested with
// tests/order_cases.json.
import { columnOf } from "./columns";
import { groupingOf } from "./grouping";
import { type Standing, standingOf } from "./judgement";
import type { Store } from "./store";
import type { Study } from "./study";
import type { Judgement, Threshold } from "./verdicts";
import { aggregated } from "./views/designs/values";
import { scaleOf } from "./views/shared/margins";

/** Verdicts on requirements of one severity ("" for none): how many of each design, missed ones for certain, and doubtful ones. */
export interface SeverityClass {
  severity: string;
  /** As requirements have it. */
  level: number;
  judged: Int32Array;
  certain: Int32Array;
  doubtful: Int32Array;
}

export interface DesignOrder {
  /** Those of requirements that are on, the highest first. */
  classes: SeverityClass[];
  /** What decides, by column: not run at all conditions; of each class missed verdicts for certain, and doubtful ones;
   * objectives; least margin. The smaller value is ahead. */
  keys: Float64Array[];
  /** Designs, the first first, and the place of each. */
  ranked: Int32Array;
  place: Int32Array;
  /** Least margins as shares, infinite where none is judged. */
  slack: Float64Array;
}

export interface Aim {
  title: string;
  unit: string;
  text: (value: number) => string;
  /** Of a design. */
  values: Float64Array;
  maximize: boolean;
}

/** What the study asks for, in its order. */
export function aimsOf(study: Study): Aim[] {
  return study.objectives.map(({ column, maximize }) => {
    const { title, unit, text, values } = columnOf(study, column)!;
    return { title, unit, text, maximize, values: aggregated(study, values, maximize ? "max" : "min") };
  });
}

export function severityOf(study: Study, index: number): string {
  const { origin } = study.requirements[index]!;
  return (origin.find(([name]) => name === "severity")?.[1] ?? "").trim().toLowerCase();
}

/** Designs that came to *standing*, at *thresholds*. */
export function designOrder(study: Study, thresholds: Threshold[], standing: Standing): DesignOrder {
  const { size, whole } = groupingOf(study);
  const used = study.requirements.map((_, index) => index).filter((index) => !thresholds[index]!.off);
  const levels = [...new Set(used.map((index) => study.requirements[index]!.level))].sort((a, b) => a - b);
  const slack = new Float64Array(size).fill(Infinity);
  const classes = levels.map((level): SeverityClass => {
    const own = used.filter((index) => study.requirements[index]!.level === level);
    const sum = (counts: Int32Array[]): Int32Array =>
      Int32Array.from(slack, (_, design) => own.reduce((all, index) => all + counts[index]![design]!, 0));
    const { judged, certain, doubtful } = standing;
    return {
      severity: severityOf(study, own[0]!),
      level,
      judged: sum(judged),
      certain: sum(certain),
      doubtful: sum(doubtful),
    };
  });
  for (const index of used) {
    const [margins, worst] = [standing.margins[index]!, standing.worst[index]!];
    const scale = scaleOf(study, index, thresholds[index]!);
    for (let design = 0; design < size; design++) {
      if (worst[design]! < 0) continue;
      const share = margins[design]! / scale;
      slack[design] = Math.min(slack[design]!, Number.isNaN(share) ? -Infinity : share);
    }
  }
  const keys = [
    Float64Array.from(whole, (each) => 1 - each),
    ...classes.flatMap(({ certain, doubtful }) => [Float64Array.from(certain), Float64Array.from(doubtful)]),
    ...aimsOf(study).map(({ values, maximize }) => values.map((value) => significant(maximize ? -value : value))),
    slack.map((share) => significant(-share)),
  ];
  const ranked = Int32Array.from(whole.keys()).sort((a, b) => aheadBy(keys, b, a)[0] || a - b);
  const place = new Int32Array(size);
  ranked.forEach((design, index) => {
    place[design] = index;
  });
  return { classes, keys, ranked, place, slack };
}

const known = new WeakMap<Judgement, DesignOrder>();

/** The order at the thresholds that are set. */
export function orderAt({ study, state, judgement }: Pick<Store, "study" | "state" | "judgement">): DesignOrder {
  const judged = judgement();
  let order = known.get(judged);
  if (!order) {
    order = designOrder(study, state.thresholds, standingOf(study, state.thresholds, 0, judged));
    known.set(judged, order);
  }
  return order;
}

/** Which of two designs is ahead, and the column that decides; -1 if none does. */
export function aheadBy(keys: Pick<Float64Array, number>[], first: number, second: number): [Ahead, number] {
  for (let column = 0; column < keys.length; column++) {
    const [a, b] = [keys[column]![first]!, keys[column]![second]!];
    if (a !== b) return [a < b ? 1 : -1, column];
  }
  return [0, -1];
}

export type Ahead = 1 | 0 | -1;

const DIGITS = 10;

/** Without the digits that are rounding; what is not a number is last. */
function significant(value: number): number {
  return Number.isNaN(value) ? Infinity : Number(value.toPrecision(DIGITS));
}

/** Missed verdicts of each class that has some: `2 of 9 major (1 doubtful)`; of one class `2 of 45`. */
export function missedText({ classes }: DesignOrder, design: number): string {
  const parts = classes.map(({ severity, judged, certain, doubtful }) => {
    const missed = certain[design]! + doubtful[design]!;
    if (!missed) return "";
    const unsure = doubtful[design]!;
    const how = unsure === missed ? " (doubtful)" : unsure ? ` (${unsure} doubtful)` : "";
    return `${`${missed} of ${judged[design]} ${severity || (classes.length > 1 ? "others" : "")}`.trim()}${how}`;
  });
  return parts.filter(Boolean).join(", ") || "none";
}
