// How many runs carry each mark, among those that are looked at.
import { type Plane, plotted } from "./plane/plane";
import type { Store } from "./store";
import type { Study } from "./study";
import type { Threshold } from "./verdicts";

const joined = new WeakMap<Plane, Int32Array>();

/** What the constraint plot draws; where there is no plane, all that is judged. */
export function shownRuns(store: Store): Int32Array {
  if (!plotted(store.study)) return store.points().runs;
  const plane = store.plane();
  const { on, beside } = plane;
  if (!beside.length) return on;
  let both = joined.get(plane);
  if (!both) {
    both = new Int32Array(on.length + beside.length);
    both.set(on);
    both.set(beside, on.length);
    joined.set(plane, both);
  }
  return both;
}

/** How many of *runs* (null: every run) that lie *within* (null: all) carry each mark. */
export function countMarks(marks: Uint8Array, runs: Int32Array | null, within: Uint8Array | null): number[] {
  const counts = [0, 0, 0, 0, 0];
  const size = runs ? runs.length : marks.length;
  for (let i = 0; i < size; i++) {
    const run = runs ? runs[i]! : i;
    if (!within || within[run]) counts[marks[run]!]!++;
  }
  return counts;
}

/** The requirements that count, in words: "every requirement", "the 2 requirements switched on". */
export function requirementsInWords(store: Store): string {
  const on = switchedOn(store).length;
  if (on === store.study.requirements.length) return "every requirement";
  return on === 1 ? "the one requirement that is switched on" : `the ${on} requirements that are switched on`;
}

/** Positions of the requirements that are not switched off. */
export function switchedOn({ study, state }: { study: Study; state: Store["state"] }): number[] {
  return study.requirements.map((_, index) => index).filter((index) => !state.thresholds[index]!.off);
}

/** The thresholds, with those off that apply to no run that is shown. */
export function thresholdsHere(store: Store): Threshold[] {
  const runs = shownRuns(store);
  return store.state.thresholds.map((threshold, index) => {
    const { applies } = store.study.requirements[index]!;
    return !applies || runs.some((run) => applies[run]) ? threshold : { ...threshold, off: true };
  });
}
