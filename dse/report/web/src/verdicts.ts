// Verdicts at the thresholds the reader has set; the same rule as dse/metrics/verdicts.py (both are tested with tests/verdict_cases.json).

import { FAIL, FAILED, NOT_APPLICABLE, NOT_EXERCISED, PASS } from "./marks";
import type { Study } from "./study";

export * from "./marks";

export interface Threshold {
  atMost: number | null;
  atLeast: number | null;
  /** Left out of the verdict on a run; its own verdict is there all the same. */
  off?: boolean;
}

export interface Judgement {
  each: Uint8Array[];
  overall: Uint8Array;
  /** Which runs have a verdict that finer numerics or more draws may change. */
  doubtful: Uint8Array;
}

export function judge(study: Study, thresholds: Threshold[]): Judgement {
  const each = study.requirements.map((_, index) => marksAt(study, index, thresholds[index]!));
  const overall = new Uint8Array(study.size);
  for (const [index, marks] of each.entries()) {
    if (thresholds[index]!.off) continue;
    for (let run = 0; run < overall.length; run++) {
      if (marks[run] === FAIL) overall[run] = FAIL;
      else if (marks[run] === NOT_EXERCISED && overall[run] === PASS) overall[run] = NOT_EXERCISED;
    }
  }
  for (let run = 0; run < overall.length; run++) if (!study.done[run]) overall[run] = FAILED;
  const doubtful = new Uint8Array(study.size);
  thresholds.forEach((threshold, index) => {
    const { metric, unsettled, draws } = study.requirements[index]!;
    // Where nothing was checked, there is nothing to go through a million runs for.
    if (threshold.off || (!unsettled && !draws && !study.metrics[metric]!.error)) return;
    for (let run = 0; run < doubtful.length; run++) if (isDoubtful(study, index, run, threshold)) doubtful[run] = 1;
  });
  return { each, overall, doubtful };
}

/** The error bar of a metric in one run; null if nobody has looked. */
export function errorOf(study: Study, metric: number, run: number): number | null {
  const isChecked = study.done[run] && (study.checked?.[run] ?? 1);
  return isChecked ? (study.metrics[metric]!.error?.[run] ?? null) : null;
}

/** What the draws of a run come to, counted at the bounds of *threshold*; null if that is not known. */
export function drawsAt(study: Study, index: number, run: number, threshold: Threshold) {
  const { draws, atMost, atLeast } = study.requirements[index]!;
  if (!draws?.judged[run] || atMost !== threshold.atMost || atLeast !== threshold.atLeast) return null;
  return { met: draws.met[run]!, judged: draws.judged[run]!, low: draws.low[run]!, high: draws.high[run]! };
}

/** Whether the draws of a run differ, and do not tell if enough of them meet a requirement. */
function isOpen(study: Study, index: number, run: number, threshold: Threshold): boolean {
  const found = drawsAt(study, index, run, threshold);
  if (!found?.met || found.met === found.judged) return false;
  const { metIn } = study.requirements[index]!;
  return found.low < metIn && found.high >= metIn;
}

/** Whether finer numerics or more draws may change the verdict of a run on a requirement; false if nothing was checked. */
export function isDoubtful(study: Study, index: number, run: number, threshold: Threshold): boolean {
  const { metric, exercised, unsettled } = study.requirements[index]!;
  if (unsettled?.[run] || isOpen(study, index, run, threshold)) return true;
  const error = errorOf(study, metric, run);
  if (error === null || !exercised[run]) return false;
  const by = margin(study.metrics[metric]!.values[run]!, threshold);
  return Number.isNaN(by) ? error === Infinity : !(Math.abs(by) > error);
}

/** Positive inside the bounds, NaN where the metric is undefined. */
export function margin(value: number, { atMost, atLeast }: Threshold): number {
  const above = atLeast === null ? Infinity : value - atLeast;
  const below = atMost === null ? Infinity : atMost - value;
  return Number.isNaN(value) ? NaN : Math.min(above, below);
}

/** How many of *runs*, or of all, that are of one configuration, or of any (-1), carry each mark. */
export function tally(
  study: Study,
  marks: Uint8Array,
  configuration: number,
  runs: Iterable<number> = marks.keys(),
): number[] {
  const counts = [0, 0, 0, 0, 0];
  for (const run of runs) {
    if (configuration < 0 || study.configuration[run] === configuration) counts[marks[run]!]!++;
  }
  return counts;
}

const marked = new WeakMap<Study, { threshold: Threshold; marks: Uint8Array }[]>();

// A slider moves one threshold; the marks at the others stay.
function marksAt(study: Study, index: number, threshold: Threshold): Uint8Array {
  const kept = marked.get(study) ?? [];
  marked.set(study, kept);
  const last = kept[index];
  if (last && last.threshold.atMost === threshold.atMost && last.threshold.atLeast === threshold.atLeast)
    return last.marks;
  const marks = marksOf(study, index, threshold);
  kept[index] = { threshold, marks };
  return marks;
}

// Comparisons with NaN are false, so that an undefined metric never passes.
function marksOf(study: Study, index: number, { atMost, atLeast }: Threshold): Uint8Array {
  const { metric, exercised, applies } = study.requirements[index]!;
  const values = study.metrics[metric]!.values;
  const high = atMost ?? Infinity;
  const low = atLeast ?? -Infinity;
  const marks = new Uint8Array(study.size);
  for (let run = 0; run < marks.length; run++) {
    const value = values[run]!;
    if (applies && !applies[run]) marks[run] = NOT_APPLICABLE;
    else if (!study.done[run]) marks[run] = FAILED;
    else if (!exercised[run]) marks[run] = NOT_EXERCISED;
    else marks[run] = value <= high && value >= low ? PASS : FAIL;
  }
  return marks;
}
