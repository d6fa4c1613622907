// What is judged: a run; where conditions are varied a design, at the worst of the conditions that are let through.

import { withUnit } from "./format";
import { type Grouping, pooledOver } from "./grouping";
import { standingOf } from "./judgement";
import type { State, Store } from "./store";
import type { Study } from "./study";
import type { Judgement } from "./verdicts";

export interface Points {
  noun: "run" | "design" | "point";
  /** The first run of each: where it lies. */
  runs: Int32Array;
  /** By run, the marks of the point that it belongs to. */
  judgement: Judgement;
  /** By run, whether any run of its point lies within the brushes; null if there is no brush. */
  within: Uint8Array | null;
  /** The first run of the point that a run belongs to, -1 if its condition is not let through. */
  first(run: number): number;
  /** The run that decides on it: one that failed to run, else that of the least margin. */
  deciding(run: number): number;
}

type Let = Pick<State, "x" | "y" | "fixed">;

/** Positions of the variables that are conditions. */
export function conditionsOf(study: Study): number[] {
  return study.variables.flatMap(({ role }, index) => (role === "condition" ? [index] : []));
}

const known = new WeakMap<Study, Map<string, Grouping>>();

/** Runs that differ only in conditions that are on no axis and not *fixed* (NaN); null where there are no conditions. */
export function poolOf(study: Study, { x, y, fixed }: Let): Grouping | null {
  const conditions = conditionsOf(study);
  if (!conditions.length || !study.size) return null;
  const free = conditions.filter((index) => index !== x && index !== y);
  const set = free.filter((index) => !Number.isNaN(fixed[index]!));
  const pooled = free.filter((index) => !set.includes(index));
  const key = `${pooled.join()};${set.map((index) => `${index}:${fixed[index]}`).join()}`;
  const groupings = known.get(study) ?? new Map<string, Grouping>();
  known.set(study, groupings);
  let grouping = groupings.get(key);
  if (!grouping) {
    const among = Int32Array.from(study.number.keys()).filter((run) =>
      set.every((index) => study.variables[index]!.values[run] === fixed[index]),
    );
    grouping = pooledOver(study, new Set(pooled.map((index) => study.variables[index]!)), among);
    groupings.set(key, grouping);
  }
  return grouping;
}

/** What lets all conditions through, whatever the axes are. */
export function everyCondition({ variables }: Study): Let {
  return { x: -1, y: -1, fixed: variables.map(() => NaN) };
}

export function pointsOf(store: Pick<Store, "study" | "state" | "judgement" | "within">, at: Let): Points {
  const { study, state } = store;
  const grouping = poolOf(study, at);
  const judgement = store.judgement();
  if (!grouping) {
    return {
      noun: "run",
      runs: Int32Array.from(study.number.keys()),
      judgement,
      within: store.within(),
      first: (run) => run,
      deciding: (run) => run,
    };
  }
  const { of, first, start, rows } = grouping;
  const standing = standingOf(study, state.thresholds, 0, judgement, grouping);
  const spread = (marks: Uint8Array, own: Uint8Array): Uint8Array =>
    own.map((mark, run) => (of[run]! < 0 ? mark : marks[of[run]!]!));
  const anyOf = (flags: Uint8Array): Uint8Array => {
    const found = new Uint8Array(grouping.size);
    for (let point = 0; point < found.length; point++)
      for (let i = start[point]!; i < start[point + 1]!; i++) found[point]! |= flags[rows[i]!]!;
    return spread(found, flags);
  };
  const within = store.within();
  return {
    noun: conditionsOf(study).some((index) => index === at.x || index === at.y) ? "point" : "design",
    runs: first,
    judgement: {
      each: standing.each.map((marks, index) => spread(marks, judgement.each[index]!)),
      overall: spread(standing.mark, judgement.overall),
      doubtful: anyOf(judgement.doubtful),
    },
    within: within && anyOf(within),
    first: (run) => (run < 0 || of[run]! < 0 ? -1 : first[of[run]!]!),
    deciding: (run) => (run < 0 || of[run]! < 0 ? run : standing.deciding[of[run]!]!),
  };
}

/** At which conditions points are judged: ` at the worst of 2 conditions`, ` at mass 60 kg`; "" where there are none. */
export function conditionsInWords(study: Study, at: Let): string {
  const grouping = poolOf(study, at);
  if (!grouping) return "";
  const set = conditionsOf(study).filter(
    (index) => index !== at.x && index !== at.y && !Number.isNaN(at.fixed[index]!),
  );
  const told = set.map((index) => {
    const { title, text, unit } = study.variables[index]!;
    return `${title} ${withUnit(text(at.fixed[index]!), unit)}`;
  });
  if (grouping.conditions > 1) told.push(`the worst of ${grouping.conditions} conditions`);
  return told.length ? ` at ${told.join(", ")}` : "";
}
