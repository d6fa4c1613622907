// Whether the reader's thresholds are the study's own.
import type { Threshold } from "../../verdicts";

export function isAsStudied(set: Threshold[], original: Threshold[]): boolean {
  return original.every(({ atMost, atLeast }, index) => {
    const now = set[index]!;
    return atMost === now.atMost && atLeast === now.atLeast && !now.off;
  });
}
