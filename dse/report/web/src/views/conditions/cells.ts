// What is in a cell of the verdict matrix: the runs there, how they fare, and the worst of them.
import type { Store } from "../../store";
import { FAIL, FAILED, margin, NOT_APPLICABLE, NOT_EXERCISED, PASS } from "../../verdicts";
import { leastMargin } from "../shared/margins";
import type { Levels } from "./levels";

export interface Cell {
  runs: number[];
  /** By mark. */
  counts: number[];
  /** The run with the least margin, or one without a verdict if there is no other; -1 in an empty cell. */
  worst: number;
  /** Its margin, in the metric's unit or, of all requirements, as a share; NaN where there is none. */
  margin: number;
}

/** Cells row by row, of the runs that are *among*; of *requirement*, or -1 for all together. */
export function cellsOf(
  store: Store,
  x: Levels,
  y: Levels,
  requirement: number,
  among: (run: number) => boolean,
): Cell[][] {
  const { study, state } = store;
  const { each, overall } = store.judgement();
  const marks = requirement < 0 ? overall : each[requirement]!;
  const cells = y.labels.map(() =>
    x.labels.map((): Cell => ({ runs: [], counts: [0, 0, 0, 0, 0], worst: -1, margin: NaN })),
  );
  for (let run = 0; run < study.size; run++) {
    if (!among(run)) continue;
    const cell = cells[y.of[run]!]![x.of[run]!]!;
    const mark = marks[run]!;
    cell.runs.push(run);
    cell.counts[mark]!++;
    const judged = mark === PASS || mark === FAIL;
    const here = !judged
      ? NaN
      : requirement < 0
        ? leastMargin(store, run)
        : margin(study.metrics[study.requirements[requirement]!.metric]!.values[run]!, state.thresholds[requirement]!);
    if (cell.worst < 0 || here < cell.margin || (Number.isNaN(cell.margin) && !Number.isNaN(here))) {
      cell.worst = run;
      cell.margin = here;
    }
  }
  return cells;
}

/** The mark of a cell: the worst that happens in it, as no design that fails there passes. */
export function markOf({ counts }: Cell): number {
  if (counts[FAILED]) return FAILED;
  if (counts[FAIL]) return FAIL;
  if (counts[NOT_EXERCISED]) return NOT_EXERCISED;
  return counts[NOT_APPLICABLE] && !counts[PASS] ? NOT_APPLICABLE : PASS;
}
