// What the runs of a design come to under a requirement, for a review.
import type { Grouping } from "../../grouping";
import type { Store } from "../../store";
import { drawsAt, errorOf, FAIL, FAILED, margin, NOT_EXERCISED, PASS, tally } from "../../verdicts";

export interface Result {
  /** Its worst mark in any run: `PASS` if each run that exercises the requirement passes. */
  mark: number;
  /** How many runs have each mark. */
  counts: number[];
  /** The run with the least margin, -1 if none is judged, its margin and its error bar. */
  run: number;
  margin: number;
  error: number | null;
  /** The least share of the draws of any run, and between which rates that leaves it; null without draws. */
  rate: { value: number; low: number; high: number } | null;
  /** Runs that miss it, or failed to run. */
  missing: number[];
}

export function resultOf(
  { study, state, judgement }: Store,
  grouping: Grouping,
  index: number,
  design: number,
): Result {
  const runs = grouping.rows.subarray(grouping.start[design]!, grouping.start[design + 1]!);
  const threshold = state.thresholds[index]!;
  const marks = judgement().each[index]!;
  const { metric } = study.requirements[index]!;
  const counts = tally(study, marks, -1, runs);
  const result: Result = {
    mark: counts[FAIL] ? FAIL : counts[FAILED] ? FAILED : counts[PASS] ? PASS : NOT_EXERCISED,
    counts,
    run: -1,
    margin: NaN,
    error: null,
    rate: null,
    missing: Array.from(runs).filter((run) => marks[run] === FAIL || marks[run] === FAILED),
  };
  for (const run of runs) {
    if (marks[run] !== PASS && marks[run] !== FAIL) continue;
    const by = margin(study.metrics[metric]!.values[run]!, threshold);
    // What is undefined is missed by no known margin: nothing is worse.
    if (result.run < 0 || by < result.margin || (Number.isNaN(by) && !Number.isNaN(result.margin)))
      Object.assign(result, { run, margin: by, error: errorOf(study, metric, run) });
    const draws = drawsAt(study, index, run, threshold);
    if (draws && (!result.rate || draws.met / draws.judged < result.rate.value))
      result.rate = { value: draws.met / draws.judged, low: draws.low, high: draws.high };
  }
  return result;
}
