// Verdicts over two conditions: of the selected design, or of all designs together.
import { card, choose, el, field } from "../../dom";
import type { Store } from "../../store";
import { studyThresholds } from "../../store";
import type { Study } from "../../study";
import { isAsStudied } from "../shared/thresholds";
import type { View } from "../view";
import { createMatrix } from "./matrix";
import { type Chosen, chosenOf, setChosen } from "./selection";

export const conditionsView: View = {
  name: "conditions",
  title: "Conditions",
  suits: (study) => study.size > 0 && conditionsOf(study).length > 0,
  create(store) {
    const { study } = store;
    const conditions = conditionsOf(study);
    let chosen = chosenOf(store, conditions);
    const box = el("div", { class: "matrix-box" });
    const draw = (): void => box.replaceChildren(createMatrix(store, chosen));
    draw();
    const { element, show } = controls(store, conditions);
    store.subscribe((_, changed) => {
      const now = changed.has("settings") ? chosenOf(store, conditions) : chosen;
      const isOther = JSON.stringify(now) !== JSON.stringify(chosen);
      chosen = now;
      if (isOther) show(chosen);
      if (isOther || ["thresholds", "selected", "configuration", "theme"].some((key) => changed.has(key as never)))
        draw();
    });
    return el("div", { class: "conditions" }, card("verdicts", "Verdicts over the conditions", element, box));
  },
};

/** Conditions, then what is uncertain, by their positions among the variables; none without a condition. */
export function conditionsOf(study: Study): number[] {
  const roles = study.insight?.asked.roles ?? [];
  const of = (role: string): number[] => roles.flatMap((each, index) => (each === role ? [index] : []));
  const conditions = of("condition");
  return conditions.length ? [...conditions, ...of("uncertain")] : [];
}

function controls(
  store: Store,
  conditions: readonly number[],
): { element: HTMLElement; show: (chosen: Chosen) => void } {
  const { study } = store;
  const options = conditions.map((index): [string, string] => [String(index), study.variables[index]!.title]);
  const about: [string, string][] = [
    ["-1", "all requirements"],
    ...study.requirements.map(({ title }, index): [string, string] => [String(index), title]),
  ];
  const set = (patch: Partial<Chosen>): void => setChosen(store, conditions, patch);
  const start = chosenOf(store, conditions);
  const x = choose(options, "", (value) => set({ x: Number(value) }));
  const y = choose(options, "", (value) => set({ y: Number(value) }));
  const requirement = choose(about, "", (value) => set({ requirement: Number(value) }));
  const whole = choose(
    [
      ["design", "the selected design"],
      ["all", "all designs"],
    ],
    "",
    (value) => set({ whole: value === "all" }),
  );
  x.id = "conditions-across";
  y.id = "conditions-down";
  requirement.id = "conditions-requirement";
  whole.id = "conditions-of";
  const show = (chosen: Chosen): void => {
    x.value = String(chosen.x);
    y.value = String(chosen.y);
    requirement.value = String(chosen.requirement);
    whole.value = chosen.whole ? "all" : "design";
  };
  show(start);
  const axes = start.y < 0 ? [] : [field("Across", x), field("Down", y)];
  const row = el("div", { class: "row" }, ...axes, field("Requirement", requirement), field("Of", whole));
  const note = el("p", { class: "hint" });
  const explain = (): void => {
    note.textContent = isAsStudied(store.state.thresholds, studyThresholds(study))
      ? ""
      : "At the thresholds you have set.";
  };
  explain();
  store.subscribe((_, changed) => {
    if (changed.has("thresholds")) explain();
  });
  return { element: el("div", { class: "controls" }, row, note), show };
}
