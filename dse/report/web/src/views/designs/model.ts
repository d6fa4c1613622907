// What the reader has chosen among designs, and what follows from it; the parts of the view draw from here.
import { columnOf } from "../../columns";
import { shortened, withUnit } from "../../format";
import { type Grouping, groupingOf, variablesOf } from "../../grouping";
import { type Standing, standingOf } from "../../judgement";
import { type DesignOrder, designOrder } from "../../order";
import type { Changed, State, Store } from "../../store";
import type { Study } from "../../study";
import { PASS } from "../../verdicts";
import { type Choices, type Criterion, MOST_COMPARED, readChoices, withChoices } from "./choices";
import { frontOf } from "./front";
import { topsis } from "./topsis";
import { aggregated, type DesignColumn, designColumns, place, type Sense, senseOf } from "./values";

export { type Criterion, MOST_COMPARED };

type Key = keyof Choices | keyof State;
export type ChangedKeys = ReadonlySet<Key>;

export interface Model {
  readonly store: Store;
  readonly grouping: Grouping;
  readonly choices: Choices;
  set(patch: Partial<Choices>): void;
  /** Hears of what is chosen here and of what is chosen in the whole page. */
  subscribe(listener: (changed: ChangedKeys) => void): void;
  standing(): Standing;
  order(): DesignOrder;
  column(key: string): DesignColumn;
  /** Which designs lie within all brushes; null if there is no brush. */
  within(): Uint8Array | null;
  /** Which designs are on the front of the criteria: of those that are feasible, within the brushes. */
  front(): Uint8Array;
  scores(): Float64Array;
}

export function createModel(store: Store): Model {
  const { study } = store;
  const grouping = groupingOf(study);
  const start = initial(store);
  let seen = store.state.settings;
  let choices = readChoices(study, seen, start, start);
  const current = (): Choices => {
    if (seen !== store.state.settings) {
      seen = store.state.settings;
      choices = readChoices(study, seen, start, choices);
    }
    return choices;
  };
  let told = choices;
  const listeners: ((changed: ChangedKeys) => void)[] = [];
  store.subscribe((_, changed: Changed) => {
    const now = current();
    const keys = new Set<Key>(changed);
    for (const key of Object.keys(now) as (keyof Choices)[]) if (now[key] !== told[key]) keys.add(key);
    told = now;
    for (const listener of listeners) listener(keys);
  });

  const columns = new Map<string, DesignColumn>();
  const remembered = new Map<string, { of: readonly unknown[]; value: unknown }>();
  const once = <T>(name: string, of: readonly unknown[], make: () => T): T => {
    const last = remembered.get(name);
    if (last?.of.every((one, index) => one === of[index])) return last.value as T;
    const value = make();
    remembered.set(name, { of, value });
    return value;
  };
  const sense = (key: string): Sense => {
    const criterion = current().criteria.find(({ column }) => column === key);
    return criterion ? (criterion.maximize ? "max" : "min") : senseOf(store, key);
  };
  const column = (key: string): DesignColumn => {
    const way = sense(key);
    const name = `${key} ${way}`;
    let found = columns.get(name);
    if (!found) {
      const keyed = columnOf(study, key)!;
      found = { ...keyed, values: aggregated(study, keyed.values, way), sense: way };
      columns.set(name, found);
    }
    return found;
  };
  const standing = (): Standing =>
    once("standing", [store.state.thresholds, current().demand], () =>
      standingOf(study, store.state.thresholds, current().demand, store.judgement()),
    );
  const within = (): Uint8Array | null =>
    once("within", [store.state.brushes, current().criteria], () =>
      store.state.brushes.length ? brushed(store, grouping, column) : null,
    );
  const feasible = (): Uint8Array =>
    once("feasible", [standing(), within()], () =>
      standing().mark.map((mark, design) => (mark === PASS && (within()?.[design] ?? 1) ? 1 : 0)),
    );
  const aims = () =>
    current().criteria.map(({ column: key, maximize, weight }) => ({ values: column(key).values, maximize, weight }));
  return {
    store,
    grouping,
    get choices() {
      return current();
    },
    set(patch) {
      store.set({ settings: withChoices(study, store.state.settings, { ...current(), ...patch }, start) });
    },
    subscribe(listener) {
      listeners.push(listener);
    },
    standing,
    order: () => once("order", [standing()], () => designOrder(study, store.state.thresholds, standing())),
    column,
    within,
    front: () => once("front", [feasible(), current().criteria], () => frontOf(aims(), feasible())),
    scores: () => once("scores", [feasible(), current().criteria], () => topsis(aims(), feasible())),
  };
}

/** A design lies within a range if its own value does; of what it is only tried at, if that of any run does. */
function brushed(store: Store, { size, of }: Grouping, column: (key: string) => DesignColumn): Uint8Array {
  const { study, state } = store;
  const mask = new Uint8Array(size).fill(1);
  const own = new Set(designColumns(study).map(({ key }) => key));
  for (const { column: key, low, high } of state.brushes) {
    const keyed = columnOf(study, key);
    if (!keyed) continue;
    if (own.has(key)) {
      const { values } = column(key);
      for (let design = 0; design < size; design++)
        if (!(values[design]! >= low && values[design]! <= high)) mask[design] = 0;
      continue;
    }
    const any = new Uint8Array(size);
    for (let run = 0; run < of.length; run++)
      if (keyed.values[run]! >= low && keyed.values[run]! <= high) any[of[run]!] = 1;
    for (let design = 0; design < size; design++) mask[design]! &= any[design]!;
  }
  return mask;
}

function initial(store: Store): Choices {
  const { study } = store;
  const columns = designColumns(study);
  // Without objectives nobody said what is better: there is no score.
  const criteria = study.objectives.map(({ column, maximize }): Criterion => ({ column, maximize, weight: 5 }));
  const axes = [...startingColumns(store), ...columns.map(({ key }) => key)];
  const x = axes[0] ?? "";
  return {
    demand: 0,
    criteria,
    x,
    y: axes.find((key) => key !== x) ?? x,
    colour: "verdict",
    points: variablesOf(study, "design").length || study.configurations.length > 1 ? "designs" : "runs",
    picked: [],
    sort: { column: "place", descending: false },
    boxes: x,
    among: "all",
    case: -1,
  };
}

// What the study asks for, else the first property; and the metrics that have requirements.
function startingColumns(store: Store): string[] {
  const { study } = store;
  const stated = study.objectives.map(({ column }) => column);
  if (stated.length > 1) return stated;
  const judged = study.requirements.map(({ metric }) => `metric.${metric}`).filter((key) => senseOf(store, key));
  const differing = study.properties.findIndex(({ values }) => values.some((value) => value !== values[0]));
  const property = differing >= 0 && !stated.length ? [`property.${differing}`] : [];
  return [...new Set([...stated, ...property, ...judged])].slice(0, 3);
}

const MANY = 20_000;
const CALM = 160;

/** Whether what takes long waits until a slider rests. */
export function isLarge({ grouping }: Model): boolean {
  return grouping.size > MANY;
}

/** As `subscribe`; of a large study what has changed arrives together when nothing has for a moment. */
export function subscribeCalmly(model: Model, listener: (changed: ChangedKeys) => void): void {
  let gathered = new Set<Key>();
  let timer = 0;
  const tell = (): void => {
    const changed = gathered;
    gathered = new Set();
    listener(changed);
  };
  model.subscribe((changed) => {
    for (const key of changed) gathered.add(key);
    clearTimeout(timer);
    if (isLarge(model)) timer = window.setTimeout(tell, CALM);
    else tell();
  });
}

const MOST_PART = 60;

/** What a design is called: what it chooses where configurations differ, and its values of the design variables. What
 * configurations choose at several of these places is named with its place. */
export function nameOf(model: Model, design: number): string {
  const { store, grouping } = model;
  const configuration = configurationOf(model, design);
  const { places, repeated } = differingIn(store.study);
  const chosen = places.map((name) => {
    const choice = choiceAt(store, configuration, name);
    return repeated.has(choice) ? `${choice} at ${name}` : choice;
  });
  const has = variablesOf(store.study, "design").filter(({ lack }) => !lack.includes(configuration));
  const values = has.map(
    ({ title, unit, values, text }) => `${title} ${withUnit(text(values[grouping.first[design]!]!), unit)}`,
  );
  return (
    [...chosen, ...values]
      .filter(Boolean)
      .map((part) => shortened(part, MOST_PART))
      .join(", ") || store.study.configurations[configuration]!.id
  );
}

/** The choice that *configuration* makes at the place *name*, "" where it has none. */
export function choiceAt(store: Store, configuration: number, name: string): string {
  return store.study.configurations[configuration]!.choices.find(([key]) => key === name)?.[1] ?? "";
}

export function configurationOf({ store, grouping }: Model, design: number): number {
  return store.study.configuration[grouping.first[design]!]!;
}

interface Differing {
  places: string[];
  /** What is chosen at several of the places. */
  repeated: Set<string>;
}

const differing = new WeakMap<Study, Differing>();

/** The places at which configurations choose differently, in the order of the design space. */
export function differingPlaces({ study }: Store): string[] {
  return differingIn(study).places;
}

function differingIn(study: Study): Differing {
  let found = differing.get(study);
  if (!found) {
    found = placesThatDiffer(study);
    differing.set(study, found);
  }
  return found;
}

function placesThatDiffer({ configurations }: Study): Differing {
  const chosen = new Map<string, Set<string>>();
  const times = new Map<string, number>();
  for (const { choices } of configurations)
    for (const [place, choice] of choices) {
      times.set(place, (times.get(place) ?? 0) + 1);
      chosen.set(place, (chosen.get(place) ?? new Set()).add(choice));
    }
  const places = [...chosen.keys()].filter(
    (place) => chosen.get(place)!.size > 1 || times.get(place)! < configurations.length,
  );
  const all = places.flatMap((place) => [...chosen.get(place)!]);
  return { places, repeated: new Set(all.filter((choice, index) => all.indexOf(choice) !== index)) };
}

/** Whether the design has the variable of a column; others have a value to stand somewhere. */
export function hasVariable(model: Model, key: string, design: number): boolean {
  return (
    !key.startsWith("variable.") ||
    !model.store.study.variables[place(key)]!.lack.includes(configurationOf(model, design))
  );
}

/** Adds a design to those compared, or takes it away; beyond the most, the oldest goes. */
export function togglePick(model: Model, design: number): void {
  const { picked } = model.choices;
  model.set({
    picked: picked.includes(design)
      ? picked.filter((one) => one !== design)
      : [...picked, design].slice(-MOST_COMPARED),
  });
}
