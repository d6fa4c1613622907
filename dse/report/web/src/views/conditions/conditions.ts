// Verdicts over two conditions: of the selected design, or of all designs together.
import { card, choose, el, field } from "../../dom";
import type { Store } from "../../store";
import { studyThresholds } from "../../store";
import type { Study } from "../../study";
import type { View } from "../view";
import { isAsStudied } from "../shared/thresholds";
import { createMatrix } from "./matrix";

export interface Chosen {
  x: number;
  /** -1 where there is one condition only. */
  y: number;
  /** -1 for all together. */
  requirement: number;
  whole: boolean;
}

export const conditionsView: View = {
  name: "conditions",
  title: "Conditions",
  suits: (study) => conditionsOf(study).length > 0,
  create(store) {
    const { study } = store;
    const conditions = conditionsOf(study);
    const chosen: Chosen = { x: conditions[0]!, y: conditions[1] ?? -1, requirement: -1, whole: false };
    const box = el("div", { class: "matrix-box" });
    const draw = (): void => box.replaceChildren(createMatrix(store, chosen));
    const set = (patch: Partial<Chosen>): void => {
      Object.assign(chosen, patch);
      draw();
    };
    draw();
    store.subscribe((_, changed) => {
      if (["thresholds", "selected", "configuration", "theme"].some((key) => changed.has(key as never))) draw();
    });
    return el("div", { class: "conditions" }, card("verdicts", "Verdicts over the conditions", controls(store, conditions, chosen, set), box));
  },
};

/** Conditions, then what is uncertain, by their positions among the variables; none without a condition. */
export function conditionsOf(study: Study): number[] {
  const roles = study.insight?.asked.roles ?? [];
  const of = (role: string): number[] => roles.flatMap((each, index) => (each === role ? [index] : []));
  const conditions = of("condition");
  return conditions.length ? [...conditions, ...of("uncertain")] : [];
}

function controls(store: Store, conditions: number[], chosen: Chosen, set: (patch: Partial<Chosen>) => void): HTMLElement {
  const { study } = store;
  const options = conditions.map((index): [string, string] => [String(index), study.variables[index]!.title]);
  const axis = (key: "x" | "y", text: string): HTMLElement =>
    field(
      text,
      choose(options, String(chosen[key]), (value) => {
        const other = key === "x" ? "y" : "x";
        // The same condition on both axes would be a diagonal: the axes change places instead.
        set(Number(value) === chosen[other] ? { [key]: Number(value), [other]: chosen[key] } : { [key]: Number(value) });
        for (const each of ["x", "y"] as const) (row.querySelector(`[data-axis="${each}"] select`) as HTMLSelectElement | null)!.value = String(chosen[each]);
      }),
    );
  const marked = (element: HTMLElement, key: string): HTMLElement => {
    element.dataset["axis"] = key;
    return element;
  };
  const about: [string, string][] = [["-1", "all requirements"], ...study.requirements.map(({ title }, index): [string, string] => [String(index), title])];
  const row = el(
    "div",
    { class: "row" },
    ...(chosen.y < 0 ? [] : [marked(axis("x", "Across"), "x"), marked(axis("y", "Down"), "y")]),
    field("Requirement", choose(about, "-1", (value) => set({ requirement: Number(value) }))),
    field("Of", choose([["design", "the selected design"], ["all", "all designs"]], "design", (value) => set({ whole: value === "all" }))),
  );
  const note = el("p", { class: "hint" });
  const explain = (): void => {
    note.textContent = isAsStudied(store.state.thresholds, studyThresholds(study)) ? "" : "At the thresholds you have set.";
  };
  explain();
  store.subscribe((_, changed) => {
    if (changed.has("thresholds")) explain();
  });
  return el("div", { class: "controls" }, row, note);
}
