// What the reader does that touches more than one choice at once.
import { fixedThrough, liesIn } from "./plane/plane";
import { MOST_PINS, type State, type Store } from "./store";
import { PASS } from "./verdicts";

/** Selects a run; where it is not in the plane shown, moves the plane to it. */
export function selectRun(store: Store, run: number): void {
  const { study, state } = store;
  const patch: Partial<State> = { selected: run };
  const configuration = study.configuration[run]!;
  if (configuration !== state.configuration) patch.configuration = configuration;
  if (study.variables.length >= 2 && study.sampler !== "scattered") {
    Object.assign(patch, planeThrough(store, run, configuration));
  }
  store.set(patch);
}

/** Pins a run for comparison, or takes its pin away; beyond MOST_PINS nothing is pinned. */
export function togglePin({ state, set }: Store, run: number): void {
  if (run < 0) return;
  const others = state.pins.filter((pin) => pin !== run);
  if (others.length < state.pins.length) set({ pins: others });
  else if (others.length < MOST_PINS) set({ pins: [...others, run] });
}

/** Remembers what the reader chose in a view, by a key `VIEW.NAME`; an empty *value* forgets it. */
export function setSetting({ state, set }: Store, key: string, value: string): void {
  const { [key]: _, ...others } = state.settings;
  set({ settings: value ? { ...others, [key]: value } : others });
}

/** Shows another configuration; the run at the same place, or its first, is selected. */
export function selectConfiguration(store: Store, configuration: number): void {
  store.set({ configuration, selected: counterparts(store)[configuration]! });
}

/** For every configuration its run at the parameters of the selected run, else its first run, else -1. */
export function counterparts({ study, state }: Store): number[] {
  const runs = study.configurations.map(() => -1);
  const exact = study.configurations.map(() => false);
  const same = (run: number): boolean =>
    state.selected >= 0 && study.variables.every(({ values }) => values[run] === values[state.selected]);
  for (let run = 0; run < study.size; run++) {
    const configuration = study.configuration[run]!;
    if (exact[configuration]) continue;
    exact[configuration] = same(run);
    if (exact[configuration] || runs[configuration]! < 0) runs[configuration] = run;
  }
  return runs;
}

/** Moves the plane so that it goes through the selected run. */
export function planeToSelected(store: Store): void {
  const { study, state } = store;
  if (state.selected >= 0) store.set({ fixed: fixedThrough(study, state.fixed, state.selected) });
}

function planeThrough(store: Store, run: number, configuration: number): Partial<State> {
  const { study, state } = store;
  if (liesIn(study, run, { ...state, configuration })) return {};
  if (study.sampler === "sliced") {
    for (const [x, y] of study.slices) {
      if (liesIn(study, run, { ...state, configuration, x: x!, y: y! })) return { x: x!, y: y! };
    }
  }
  return { fixed: fixedThrough(study, state.fixed, run) };
}

/** The run to begin with: the one nearest to a boundary among those that decide on what passes, of designs that pass at
 * all conditions if there are any, with waveforms if it can. */
export function startingRun(store: Store, among: Iterable<number>): number {
  const { study, state } = store;
  const {
    deciding,
    judgement: { overall },
  } = store.points();
  const everywhere = store.designs().judgement.overall;
  const narrowed = (runs: number[], suits: (run: number) => boolean): number[] =>
    runs.some(suits) ? runs.filter(suits) : runs;
  const passing = Array.from(among, deciding).filter((run) => overall[run] === PASS);
  const candidates = narrowed(
    narrowed(passing, (run) => everywhere[run] === PASS),
    (run) => study.figures.some((figure) => figure.row.has(study.number[run]!)),
  );
  const scales = study.requirements.map(({ metric }) => {
    const known = study.metrics[metric]!.values.filter(Number.isFinite).sort();
    return Math.max(1e-12, (known[Math.floor(0.9 * known.length)] ?? 1) - (known[Math.floor(0.1 * known.length)] ?? 0));
  });
  let best = -1;
  let least = Infinity;
  for (const run of candidates) {
    // The corner where all margins are small is where the requirements trade off.
    const worst = Math.max(
      0,
      ...study.requirements.map(({ metric }, index) => {
        const { atMost, atLeast, off } = state.thresholds[index]!;
        if (off) return 0;
        const value = study.metrics[metric]!.values[run]!;
        return (
          Math.min(Math.abs((atMost ?? Infinity) - value), Math.abs(value - (atLeast ?? -Infinity))) / scales[index]!
        );
      }),
    );
    if (worst < least) {
      least = worst;
      best = run;
    }
  }
  if (best >= 0) return best;
  const first = study.done.indexOf(1);
  return first >= 0 ? first : study.size ? 0 : -1;
}
