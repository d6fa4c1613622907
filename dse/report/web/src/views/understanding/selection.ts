// What the reader has chosen in this view, as settings of the page, which stand in its address.
// What stands there may be wrong or made up: what does not fit the study is as it was at the start.
import { setSetting } from "../../actions";
import type { Part, Response } from "../../insight";
import type { Store } from "../../store";
import type { Study } from "../../study";
import { placesOf } from "../shared/places";

export const MOST_VARIABLES = 6;
const METRIC = "understanding.metric";
const PART = "understanding.part";
const PLACES = "understanding.at";
const PLANES = "understanding.planes";

export interface Subject {
  part: Part;
  response: Response;
}

/** Which of the parts *told* is looked at, and which metric. */
export function subjectOf({ state }: Store, told: readonly Part[]): Subject {
  const part = told[Number(state.settings[PART])] ?? told[0]!;
  const metric = Number(state.settings[METRIC]);
  return { part, response: part.responses.find((each) => each.metric === metric) ?? part.responses[0]! };
}

export function choosePart(store: Store, index: number): void {
  setSetting(store, PART, index ? String(index) : "");
}

export function chooseMetric(store: Store, metric: number, { part }: Subject): void {
  setSetting(store, METRIC, metric === part.responses[0]!.metric ? "" : String(metric));
}

/** Where the formula is asked: where the reader moved it since the run was selected, else at that run. */
export function profilePlaces({ study, state }: Store, part: Part): number[] {
  const [run, ...places] = (state.settings[PLACES] ?? "").split(":").map(Number);
  const fits =
    run === (study.number[state.selected] ?? -1) &&
    places.length === part.factors.length &&
    places.every((place) => place >= 0 && place <= 1);
  return fits ? places : placesOf(study, part.factors, state.selected);
}

export function chooseProfilePlaces(store: Store, places: readonly number[]): void {
  const { study, state } = store;
  // Finer than a pixel of any screen.
  setSetting(
    store,
    PLACES,
    [study.number[state.selected] ?? -1, ...places.map((place) => Number(place.toFixed(5)))].join(":"),
  );
}

/** Variables of which all planes are drawn, MOST_VARIABLES at most. */
export function matrixVariables({ study, state }: Store): number[] {
  const given = (state.settings[PLANES] ?? "")
    .split(",")
    .filter((text) => /^\d{1,4}$/.test(text))
    .map(Number);
  const known = [...new Set(given)].filter((index) => index < study.variables.length).slice(0, MOST_VARIABLES);
  return known.length < 2 ? firstVariables(study) : known.sort((a, b) => a - b);
}

export function chooseMatrixVariables(store: Store, shown: readonly number[]): void {
  const text = shown.join();
  setSetting(store, PLANES, text === firstVariables(store.study).join() ? "" : text);
}

function firstVariables({ variables }: Study): number[] {
  const all = [...variables.keys()];
  const chosen = all.filter((index) => variables[index]!.role !== "condition");
  return (chosen.length < 2 ? all : chosen).slice(0, MOST_VARIABLES);
}
