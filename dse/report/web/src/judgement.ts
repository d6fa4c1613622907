// Which designs meet the requirements, and by how much: the rule of dse/exploration/designs.py at the reader's
// thresholds (both are tested with tests/design_cases.json).

import { type Grouping, groupingOf } from "./grouping";
import type { Study } from "./study";
import {
  FAIL,
  FAILED,
  isDoubtful,
  type Judgement,
  judge,
  margin,
  NOT_APPLICABLE,
  NOT_EXERCISED,
  PASS,
  type Threshold,
} from "./verdicts";
import { scaleOf } from "./views/shared/margins";

export interface Standing {
  /** Overall mark of each design; `PASS` is feasible. */
  mark: Uint8Array;
  /** By requirement: the mark of each design, its smallest margin in a run that exercised the requirement (NaN where
   * none did), and the run that has it (-1). */
  each: Uint8Array[];
  margins: Float64Array[];
  worst: Int32Array[];
  /** The least margin as a share of its scale; NaN where one is not known. */
  slack: Float64Array;
  /** The requirement whose margin that is; -1 if there is none. */
  decidedBy: Int32Array;
  /** By requirement: how many verdicts each design has, how many are missed for certain, and how many missed ones are
   * doubtful. What no run exercises is one doubtful verdict. */
  judged: Int32Array[];
  certain: Int32Array[];
  doubtful: Int32Array[];
  /** The run that decides: one that failed to run, else that of the least slack, else the first. */
  deciding: Int32Array;
}

/** *thresholds* moved inwards by the share *demand* of each scale. */
export function tightened(study: Study, thresholds: Threshold[], demand: number): Threshold[] {
  if (!demand) return thresholds;
  return thresholds.map((threshold, index) => {
    const by = demand * scaleOf(study, index, threshold);
    const { atMost, atLeast } = threshold;
    return {
      ...threshold,
      atMost: atMost === null ? null : atMost - by,
      atLeast: atLeast === null ? null : atLeast + by,
    };
  });
}

/** Designs at *thresholds*, judged with the share *demand* of margin asked for; *judgement* is that of the runs without it. */
export function standingOf(
  study: Study,
  thresholds: Threshold[],
  demand: number,
  judgement: Judgement,
  grouping = groupingOf(study),
): Standing {
  const { size, start, rows, whole } = grouping;
  const { each } = demand ? judge(study, tightened(study, thresholds, demand)) : judgement;
  const standing: Standing = {
    mark: new Uint8Array(size),
    each: each.map(() => new Uint8Array(size)),
    margins: each.map(() => new Float64Array(size).fill(NaN)),
    worst: each.map(() => new Int32Array(size).fill(-1)),
    slack: new Float64Array(size).fill(NaN),
    decidedBy: new Int32Array(size).fill(-1),
    judged: each.map(() => new Int32Array(size)),
    certain: each.map(() => new Int32Array(size)),
    doubtful: each.map(() => new Int32Array(size)),
    deciding: new Int32Array(size),
  };
  each.forEach((marks, index) => judgeOne(study, grouping, thresholds[index]!, index, marks, standing));
  const counted = each.map((_, index) => index).filter((index) => !thresholds[index]!.off);
  const { mark, slack, deciding } = standing;
  // Whether each requirement has a verdict on a design all of whose runs came to their end.
  const isKnown = new Uint8Array(size);
  for (let design = 0; design < size; design++) {
    let failed = 0;
    let decides = rows[start[design]!]!;
    for (let i = start[design + 1]! - 1; i >= start[design]!; i--) {
      if (study.done[rows[i]!]) continue;
      failed++;
      decides = rows[i]!;
    }
    deciding[design] = decides;
    mark[design] = failed ? FAILED : whole[design] ? PASS : NOT_EXERCISED;
    slack[design] = Infinity;
    isKnown[design] = failed ? 0 : 1;
  }
  // Requirement by requirement: of a hundred thousand designs that is twice as fast as design by design.
  for (const index of counted) {
    const { atMost, atLeast } = thresholds[index]!;
    const isBounded = atMost !== null || atLeast !== null;
    const scale = scaleOf(study, index, thresholds[index]!);
    const [marks, margins, worst] = [standing.each[index]!, standing.margins[index]!, standing.worst[index]!];
    for (let design = 0; design < size; design++) {
      const one = marks[design]!;
      const share = margins[design]! / scale;
      if (mark[design] !== FAILED && one === FAIL) mark[design] = FAIL;
      if (one === NOT_APPLICABLE) continue;
      if (mark[design] === PASS && one !== PASS) mark[design] = NOT_EXERCISED;
      if (one !== PASS && one !== FAIL) isKnown[design] = 0;
      else if (isBounded && mark[design] !== FAILED && !Number.isNaN(slack[design]!) && !(share >= slack[design]!)) {
        // Also what is undefined, which nothing undercuts.
        slack[design] = share;
        standing.decidedBy[design] = index;
        deciding[design] = worst[design]!;
      }
    }
  }
  for (let design = 0; design < size; design++) if (!isKnown[design] || slack[design] === Infinity) slack[design] = NaN;
  return standing;
}

/** One requirement: *marks* are those of the runs. */
function judgeOne(
  study: Study,
  { size, start, rows }: Grouping,
  threshold: Threshold,
  index: number,
  marks: Uint8Array,
  standing: Standing,
): void {
  const { values } = study.metrics[study.requirements[index]!.metric]!;
  const [each, margins, worst] = [standing.each[index]!, standing.margins[index]!, standing.worst[index]!];
  const [judged, certain, doubtful] = [standing.judged[index]!, standing.certain[index]!, standing.doubtful[index]!];
  for (let design = 0; design < size; design++) {
    // Where the points have one bench each, a requirement of other benches is none of theirs.
    let found: number = start[design]! < start[design + 1]! ? NOT_APPLICABLE : NOT_EXERCISED;
    let least = Infinity;
    let at = -1;
    for (let i = start[design]!; i < start[design + 1]!; i++) {
      const run = rows[i]!;
      const mark = marks[run]!;
      if (mark === FAIL || mark === FAILED) {
        if (isDoubtful(study, index, run, threshold)) doubtful[design]!++;
        else certain[design]!++;
        judged[design]!++;
      } else if (mark === PASS) judged[design]!++;
      if (mark === FAIL) found = FAIL;
      else if (mark === PASS && found !== FAIL) found = PASS;
      else if (mark === FAILED && found !== PASS && found !== FAIL) found = FAILED;
      else if (mark === NOT_EXERCISED && found === NOT_APPLICABLE) found = NOT_EXERCISED;
      if (mark !== PASS && mark !== FAIL) continue;
      const by = margin(values[run]!, threshold);
      // An undefined metric fails, and leaves the margin undefined.
      if (at < 0 || by < least || (Number.isNaN(by) && !Number.isNaN(least))) {
        least = by;
        at = run;
      }
    }
    // What no run exercises is not met.
    if (!judged[design] && found !== NOT_APPLICABLE) judged[design] = doubtful[design] = 1;
    each[design] = found;
    margins[design] = Number.isFinite(least) ? least : NaN;
    worst[design] = at;
  }
}
