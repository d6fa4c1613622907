// Runs as buttons: a click selects the run and opens the plot.
import { selectRun } from "../../actions";
import { el } from "../../dom";
import { shortened, withUnit } from "../../format";
import type { Store } from "../../store";
import type { Study } from "../../study";

const MOST_NAME = 32;

const known = new WeakMap<Study, Map<number, number>>();

/** The position of the run with a number, -1 if it is not in the page. */
export function positionOf(study: Study, number: number): number {
  let rows = known.get(study);
  if (!rows) {
    rows = new Map(Array.from(study.number, (each, row) => [each, row]));
    known.set(study, rows);
  }
  return rows.get(number) ?? -1;
}

export function openRun(store: Store, run: number): void {
  selectRun(store, run);
  store.set({ view: "plot" });
}

export function runButton(store: Store, run: number, text = `Run ${store.study.number[run]}`): HTMLElement {
  return el(
    "button",
    { type: "button", class: "run-button", title: "Select it and open the plot", click: () => openRun(store, run) },
    text,
  );
}

/** Where a run lies: the values of the variables it has. */
export function placeOf(study: Study, run: number): string {
  const parts = study.variables
    .filter(({ lack }) => !lack.includes(study.configuration[run]!))
    .map(({ title, unit, text, values }) => `${title} ${withUnit(text(values[run]!), unit)}`);
  if (study.configurations.length > 1) parts.unshift(architectureOf(study, study.configuration[run]!));
  return parts.join(", ");
}

/** What was chosen at the places where configurations differ, with the id. */
export function architectureOf(study: Study, configuration: number): string {
  const { id, choices } = study.configurations[configuration]!;
  const differing = choices.filter(([place, choice]) =>
    study.configurations.some((other) => (other.choices.find(([name]) => name === place)?.[1] ?? "") !== choice),
  );
  return [
    id,
    ...differing.map(([place, choice]) => `${shortened(place, MOST_NAME)} ${shortened(choice, MOST_NAME)}`),
  ].join(", ");
}
