// Margins of runs as shares of what is usual, so that those of several requirements can be compared.
import type { Store } from "../../store";
import type { Study } from "../../study";
import { margin, NOT_EXERCISED } from "../../verdicts";

const known = new WeakMap<Study, number[]>();

/** For each requirement the spread of its metric, from the tenth to the ninetieth hundredth of the runs. */
export function scalesOf(study: Study): number[] {
  let scales = known.get(study);
  if (!scales) {
    scales = study.requirements.map(({ metric }) => {
      const sorted = study.metrics[metric]!.values.filter(Number.isFinite).sort();
      const at = (share: number): number => sorted[Math.floor(share * (sorted.length - 1))] ?? 0;
      return at(0.9) - at(0.1) || at(1) - at(0) || Math.abs(at(0.5)) || 1;
    });
    known.set(study, scales);
  }
  return scales;
}

/** The least margin of a run over the requirements that count and that it exercised; NaN if one is undefined. */
export function worstMargin({ study, state, judgement }: Pick<Store, "study" | "state" | "judgement">, run: number): number {
  const scales = scalesOf(study);
  const { each } = judgement();
  let worst = Infinity;
  for (const [index, threshold] of state.thresholds.entries()) {
    if (threshold.off || each[index]![run] === NOT_EXERCISED) continue;
    const here = margin(study.metrics[study.requirements[index]!.metric]!.values[run]!, threshold) / scales[index]!;
    if (Number.isNaN(here)) return NaN;
    worst = Math.min(worst, here);
  }
  return worst;
}
