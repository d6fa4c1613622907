// Margins as shares, so that those of several requirements can be compared: one notion in all views.
import { number, withUnit } from "../../format";
import type { Store } from "../../store";
import type { Study } from "../../study";
import { margin, NOT_EXERCISED, type Threshold } from "../../verdicts";

/** What a share of margin is a share of, in words. */
export const SHARE_OF = "of the bound; of a band, of half its width; of a bound at 0, of the metric\u2019s median size";

/** The same as a number, in the metric's unit. */
export function scaleOf(study: Study, index: number, { atMost, atLeast }: Threshold): number {
  const scale = atMost !== null && atLeast !== null ? (atMost - atLeast) / 2 : Math.abs(atMost ?? atLeast ?? 1);
  return scale > 0 ? scale : medianSize(study, study.requirements[index]!.metric);
}

/** A margin as a share of `SHARE_OF`. */
export function shareText(share: number): string {
  return Number.isFinite(share) ? `${number(100 * share, 3)}\u202f%` : "undefined";
}

/** A margin in the metric's unit, with its share in brackets if it is one. */
export function marginWithShare(study: Study, index: number, threshold: Threshold, by: number): string {
  const shown = withUnit(number(by, 3), study.metrics[study.requirements[index]!.metric]!.unit);
  return isAtZero(threshold) ? shown : `${shown} (${shareText(by / scaleOf(study, index, threshold))})`;
}

/** Whether the bound is 0, so that no margin is a share of it. */
function isAtZero({ atMost, atLeast }: Threshold): boolean {
  return (atMost === null || atLeast === null || atMost === atLeast) && (atMost ?? atLeast) === 0;
}

/** The least margin of a run over the requirements that count and that it exercised, as a share; NaN if one is
 * undefined. */
export function leastMargin(
  { study, state, judgement }: Pick<Store, "study" | "state" | "judgement">,
  run: number,
): number {
  const { each } = judgement();
  let least = Infinity;
  for (const [index, threshold] of state.thresholds.entries()) {
    if (threshold.off || each[index]![run]! >= NOT_EXERCISED) continue;
    const by = margin(study.metrics[study.requirements[index]!.metric]!.values[run]!, threshold);
    least = Math.min(least, by / scaleOf(study, index, threshold));
  }
  return least;
}

const known = new WeakMap<Study, Map<number, number>>();

function medianSize(study: Study, metric: number): number {
  const sizes = known.get(study) ?? new Map<number, number>();
  known.set(study, sizes);
  let size = sizes.get(metric);
  if (size === undefined) {
    const found = study.metrics[metric]!.values.map(Math.abs)
      .filter((value) => Number.isFinite(value) && value > 0)
      .sort();
    size = found[found.length >> 1] ?? 1;
    sizes.set(metric, size);
  }
  return size;
}
