// How a run is marked: the numbers are those of `VERDICTS` in dse/domain/bench.py.
export const PASS = 0;
export const FAIL = 1;
export const NOT_EXERCISED = 2;
export const FAILED = 3;
/** The requirement is not one of the run's bench: only single requirements have this mark. */
export const NOT_APPLICABLE = 4;
export type Mark = typeof PASS | typeof FAIL | typeof NOT_EXERCISED | typeof FAILED | typeof NOT_APPLICABLE;

export const WORDS = ["pass", "fail", "not exercised", "failed to run", "does not apply"] as const;
export const SIGNS = ["\u2713", "\u2717", "\u25cb", "\u00d7", "\u2013"] as const;
export const CLASSES = ["pass", "fail", "open", "broken", "muted"] as const;

/** What an overall *mark* is called: a design that is left open may also lack a condition. */
export function wordFor(mark: number, noun: string): string {
  return mark === NOT_EXERCISED && noun !== "run" ? "undecided" : WORDS[mark]!;
}
