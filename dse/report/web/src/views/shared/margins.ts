// Margins as shares, so that those of several requirements can be compared: one notion in all views.
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

/** The least margin of a run over the requirements that count and that it exercised, as a share; NaN if one is undefined. */
export function worstMargin(
  { study, state, judgement }: Pick<Store, "study" | "state" | "judgement">,
  run: number,
): number {
  const { each } = judgement();
  let worst = Infinity;
  for (const [index, threshold] of state.thresholds.entries()) {
    if (threshold.off || each[index]![run]! >= NOT_EXERCISED) continue;
    const here =
      margin(study.metrics[study.requirements[index]!.metric]!.values[run]!, threshold) /
      scaleOf(study, index, threshold);
    if (Number.isNaN(here)) return NaN;
    worst = Math.min(worst, here);
  }
  return worst;
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
