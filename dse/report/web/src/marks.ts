// How a run is marked: the numbers are those of `VERDICTS` in dse/domain/bench.py.
export const PASS = 0;
export const FAIL = 1;
export const NOT_EXERCISED = 2;
export const FAILED = 3;
export type Mark = typeof PASS | typeof FAIL | typeof NOT_EXERCISED | typeof FAILED;

export const WORDS = ["pass", "fail", "not exercised", "failed to run"] as const;
export const SIGNS = ["\u2713", "\u2717", "\u25cb", "\u00d7"] as const;
export const CLASSES = ["pass", "fail", "open", "broken"] as const;

/** What an overall *mark* is called: a design that is left open may also lack a condition. */
export function wordFor(mark: number, noun: string): string {
  return mark === NOT_EXERCISED && noun !== "run" ? "undecided" : WORDS[mark]!;
}
