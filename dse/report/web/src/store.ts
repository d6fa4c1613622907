// What the reader has chosen. Parts of the page subscribe; changes of one animation frame arrive together.
import { type Brush, maskOf } from "./brush";
import { createPlanes, type Plane } from "./plane/plane";
import { everyCondition, type Points, pointsOf, poolOf } from "./points";
import type { Study } from "./study";
import { type Judgement, judge, type Threshold } from "./verdicts";

export interface Zoom {
  readonly x: readonly [number, number];
  readonly y: readonly [number, number];
}

export type Filter = "all" | 0 | 1 | 2 | 3;

export interface State {
  configuration: number;
  x: number;
  y: number;
  /** Value of every variable that is on no axis; NaN of a condition lets all of its values through, and the worst counts. */
  fixed: number[];
  thresholds: Threshold[];
  /** Metric shown as colour, -1 for the region that meets every requirement. */
  fill: number;
  /** Selected run (position, not number), -1 for none. */
  selected: number;
  filter: Filter;
  sort: { column: string; descending: boolean };
  /** Ranges that were dragged on axes; runs outside of any are set back everywhere. */
  brushes: readonly Brush[];
  /** Runs pinned for comparison, at most MOST_PINS. */
  pins: readonly number[];
  /** Run under the pointer, -1 for none. */
  hovered: number;
  /** The part of the plane that is shown, null for all of it. */
  zoom: Zoom | null;
  /** The view that is open, by its name. */
  view: string;
  /** What else a view lets the reader choose, by keys `VIEW.NAME`. It comes from addresses, too: check it. */
  settings: Readonly<Record<string, string>>;
  theme: "light" | "dark";
}

export type Changed = ReadonlySet<keyof State>;
type Listener = (state: State, changed: Changed) => void;

export interface Store {
  readonly study: Study;
  readonly state: State;
  set(patch: Partial<State>): void;
  /** Gives back what takes the listener away again. */
  subscribe(listener: Listener): () => void;
  /** Tells the listeners now what they would hear with the next frame. */
  flush(): void;
  judgement(): Judgement;
  plane(): Plane;
  /** What the plane is judged by: runs, or designs at the conditions that are let through. */
  points(): Points;
  /** The same over all conditions, whatever the plane is. */
  designs(): Points;
  /** Which runs lie within all brushes, 1 for each; null if there is no brush. */
  within(): Uint8Array | null;
}

export const MOST_PINS = 5;

export function createStore(study: Study, initial: State): Store {
  let state = initial;
  let judged: { thresholds: Threshold[]; judgement: Judgement } | null = null;
  let brushed: { brushes: readonly Brush[]; mask: Uint8Array | null } | null = null;
  const planes = createPlanes(study);
  let shown: { of: readonly unknown[]; points: Points } | null = null;
  let whole: { of: readonly unknown[]; points: Points } | null = null;
  let pending: Set<keyof State> | null = null;
  const { subscribe, tell } = createListeners();

  const flush = (): void => {
    if (!pending) return;
    const changed = pending;
    pending = null;
    const started = performance.now();
    tell(state, changed);
    performance.measure("update", { start: started, end: performance.now() });
  };

  const store: Store = {
    study,
    get state() {
      return state;
    },
    set(patch) {
      const keys = (Object.keys(patch) as (keyof State)[]).filter((key) => patch[key] !== state[key]);
      if (!keys.length) return;
      state = { ...state, ...patch };
      // Another plane is seen whole.
      if ((keys.includes("x") || keys.includes("y")) && !patch.zoom && state.zoom) {
        state.zoom = null;
        keys.push("zoom");
      }
      if (!pending) {
        pending = new Set();
        requestAnimationFrame(flush);
      }
      for (const key of keys) pending.add(key);
    },
    subscribe,
    flush,
    judgement() {
      if (judged?.thresholds !== state.thresholds) {
        judged = { thresholds: state.thresholds, judgement: judge(study, state.thresholds) };
      }
      return judged.judgement;
    },
    plane: () => planes(state),
    points() {
      if (poolOf(study, state) === poolOf(study, everyCondition(study))) return store.designs();
      const { x, y, fixed, thresholds, brushes } = state;
      if (![x, y, fixed, thresholds, brushes].every((one, index) => one === shown?.of[index]))
        shown = { of: [x, y, fixed, thresholds, brushes], points: pointsOf(store, state) };
      return shown!.points;
    },
    designs() {
      const { thresholds, brushes } = state;
      if (![thresholds, brushes].every((one, index) => one === whole?.of[index]))
        whole = { of: [thresholds, brushes], points: pointsOf(store, everyCondition(study)) };
      return whole!.points;
    },
    within() {
      if (brushed?.brushes !== state.brushes) brushed = { brushes: state.brushes, mask: maskOf(study, state.brushes) };
      return brushed.mask;
    },
  };
  return store;
}

/** The store as a view sees it: while the view is not shown it hears nothing, and all at once when it is shown again. */
export function whileShown(store: Store): { store: Store; show: () => void; hide: () => void } {
  const { subscribe, tell } = createListeners();
  const missed = new Set<keyof State>();
  let shown = true;
  store.subscribe((state, changed) => {
    if (shown) tell(state, changed);
    else for (const key of changed) missed.add(key);
  });
  // Getters stay getters: a copy would freeze the state.
  const quiet = Object.create(store, { subscribe: { value: subscribe } }) as Store;
  return {
    store: quiet,
    show: () => {
      shown = true;
      if (!missed.size) return;
      const changed = new Set(missed);
      missed.clear();
      tell(store.state, changed);
    },
    hide: () => {
      shown = false;
    },
  };
}

/** The store as a part of a view sees it that is made anew at times: *drop* takes all its listeners away. */
export function untilDropped(store: Store): { store: Store; drop: () => void } {
  const { subscribe, tell } = createListeners();
  const drop = store.subscribe(tell);
  return { store: Object.create(store, { subscribe: { value: subscribe } }) as Store, drop };
}

function createListeners(): { subscribe: Store["subscribe"]; tell: Listener } {
  const listeners = new Set<Listener>();
  return {
    subscribe(listener) {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
    tell(state, changed) {
      // Those that one of them takes away hear nothing any more, those that it adds not yet.
      for (const listener of [...listeners]) if (listeners.has(listener)) listener(state, changed);
    },
  };
}

export function studyThresholds(study: Study): Threshold[] {
  return study.requirements.map(({ atMost, atLeast }) => ({ atMost, atLeast }));
}
