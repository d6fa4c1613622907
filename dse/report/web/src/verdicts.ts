// Verdicts at the thresholds the reader has set; the same rule as dse/metrics/verdicts.py (both are held to tests/verdict_cases.py).
import type { Study } from "./study";
import { FAIL, FAILED, NOT_EXERCISED, PASS } from "./marks";

export * from "./marks";

export interface Threshold {
  atMost: number | null;
  atLeast: number | null;
}

export interface Judgement {
  each: Uint8Array[];
  overall: Uint8Array;
}

export function judge(study: Study, thresholds: Threshold[]): Judgement {
  const each = study.requirements.map((_, index) => marksOf(study, index, thresholds[index]!));
  const overall = new Uint8Array(study.size);
  for (const marks of each) {
    for (let run = 0; run < overall.length; run++) {
      if (marks[run] === FAIL) overall[run] = FAIL;
      else if (marks[run] === NOT_EXERCISED && overall[run] === PASS) overall[run] = NOT_EXERCISED;
    }
  }
  for (let run = 0; run < overall.length; run++) if (!study.done[run]) overall[run] = FAILED;
  return { each, overall };
}

/** Positive inside the bounds, NaN where the metric is undefined. */
export function margin(value: number, { atMost, atLeast }: Threshold): number {
  const above = atLeast === null ? Infinity : value - atLeast;
  const below = atMost === null ? Infinity : atMost - value;
  return Number.isNaN(value) ? NaN : Math.min(above, below);
}

/** How many of the runs of one configuration carry each mark; of all runs if `configuration` is -1. */
export function tally(study: Study, marks: Uint8Array, configuration: number): number[] {
  const counts = [0, 0, 0, 0];
  for (let run = 0; run < marks.length; run++) {
    if (configuration < 0 || study.configuration[run] === configuration) counts[marks[run]!]!++;
  }
  return counts;
}

// Comparisons with NaN are false, so that an undefined metric never passes.
function marksOf(study: Study, index: number, { atMost, atLeast }: Threshold): Uint8Array {
  const { metric, exercised } = study.requirements[index]!;
  const values = study.metrics[metric]!.values;
  const high = atMost ?? Infinity;
  const low = atLeast ?? -Infinity;
  const marks = new Uint8Array(study.size);
  for (let run = 0; run < marks.length; run++) {
    const value = values[run]!;
    if (!study.done[run]) marks[run] = FAILED;
    else if (!exercised[run]) marks[run] = NOT_EXERCISED;
    else marks[run] = value <= high && value >= low ? PASS : FAIL;
  }
  return marks;
}
