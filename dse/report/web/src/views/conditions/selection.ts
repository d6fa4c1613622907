// What the reader has chosen in this view, as settings of the page, which stand in its address.
// What stands there may be wrong or made up: what does not fit the study is as it was at the start.
import type { Store } from "../../store";

export interface Chosen {
  /** The conditions across and down, by their positions among the variables; down is -1 where there is one only. */
  x: number;
  y: number;
  /** -1 for all together. */
  requirement: number;
  /** All designs, not the selected one. */
  whole: boolean;
}

const [ACROSS, DOWN, REQUIREMENT, OF] = [
  "conditions.across",
  "conditions.down",
  "conditions.requirement",
  "conditions.of",
];

export function chosenOf({ study, state }: Store, conditions: readonly number[]): Chosen {
  const given = (key: string): number => Number(state.settings[key] ?? NaN);
  const fits = (index: number, other: number): boolean => conditions.includes(index) && index !== other;
  const first = conditions[0]!;
  const x = fits(given(ACROSS), -1) ? given(ACROSS) : first;
  const y = fits(given(DOWN), x) ? given(DOWN) : (conditions.find((index) => index !== x) ?? -1);
  const requirement = study.requirements[given(REQUIREMENT)] ? given(REQUIREMENT) : -1;
  return { x, y, requirement, whole: state.settings[OF] === "all" };
}

export function setChosen(store: Store, conditions: readonly number[], patch: Partial<Chosen>): void {
  const last = chosenOf(store, conditions);
  const next = { ...last, ...patch };
  // The same condition on both axes would be a diagonal: the axes change places instead.
  if (next.x === next.y && patch.x !== undefined) next.y = last.x;
  else if (next.x === next.y) next.x = last.y;
  const asAtStart = next.x === conditions[0] && next.y === (conditions[1] ?? -1);
  const told = {
    ...(asAtStart ? {} : { [ACROSS]: String(next.x), [DOWN]: String(next.y) }),
    ...(next.requirement < 0 ? {} : { [REQUIREMENT]: String(next.requirement) }),
    ...(next.whole ? { [OF]: "all" } : {}),
  };
  const others = Object.entries(store.state.settings).filter(([key]) => !key.startsWith("conditions."));
  store.set({ settings: { ...Object.fromEntries(others), ...told } });
}
