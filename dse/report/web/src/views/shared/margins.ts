// Margins as shares, so that those of several requirements can be compared: one notion in all views.
import { number, withUnit } from "../../format";
import type { Store } from "../../store";
import type { Study } from "../../study";
import { margin, NOT_EXERCISED, type Threshold } from "../../verdicts";

/** What a share of margin is a share of, in words. */
export const SHARE_OF =
  "of the bound; of a band, of half its width. A margin to a bound at 0 is no share: it is compared as one of the metric\u2019s median size, and shown in its unit";

/** The same as a number, in the metric's unit. */
export function scaleOf(study: Study, index: number, { atMost, atLeast }: Threshold): number {
  const scale = atMost !== null && atLeast !== null ? (atMost - atLeast) / 2 : Math.abs(atMost ?? atLeast ?? 1);
  return scale > 0 ? scale : medianSize(study, study.requirements[index]!.metric);
}

/** A margin as a reader compares it: as a share, but of a bound at 0, which has none, in the metric's unit. */
export function marginText(study: Study, index: number, threshold: Threshold, by: number, digits = 3): string {
  const { unit } = study.metrics[study.requirements[index]!.metric]!;
  if (isAtZero(threshold)) return withUnit(number(by, digits), unit);
  return `${number((100 * by) / scaleOf(study, index, threshold), digits)}\u202f%`;
}

/** A margin in the metric's unit, with its share in brackets if it is one. */
export function marginWithShare(study: Study, index: number, threshold: Threshold, by: number): string {
  const shown = withUnit(number(by, 3), study.metrics[study.requirements[index]!.metric]!.unit);
  return isAtZero(threshold) ? shown : `${shown} (${marginText(study, index, threshold, by)})`;
}

/** Whether the bound is 0, so that no margin is a share of it. */
export function isAtZero({ atMost, atLeast }: Threshold): boolean {
  return (atMost === null || atLeast === null || atMost === atLeast) && (atMost ?? atLeast) === 0;
}

export interface Least {
  /** The least margin as a share, for comparison only; NaN if one is undefined. */
  share: number;
  /** The same in words. */
  text: string;
}

/** The least margin of a run over the requirements that count and that it exercised. */
export function leastMargin(
  { study, state, judgement }: Pick<Store, "study" | "state" | "judgement">,
  run: number,
): Least {
  const { each } = judgement();
  let [share, text] = [Infinity, "\u2013"];
  for (const [index, threshold] of state.thresholds.entries()) {
    if (threshold.off || each[index]![run]! >= NOT_EXERCISED) continue;
    const by = margin(study.metrics[study.requirements[index]!.metric]!.values[run]!, threshold);
    const here = by / scaleOf(study, index, threshold);
    if (Number.isNaN(here)) return { share: NaN, text: "\u2013" };
    if (here < share) [share, text] = [here, marginText(study, index, threshold, by)];
  }
  return { share, text };
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
