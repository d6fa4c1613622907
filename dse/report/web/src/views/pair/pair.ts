// One design against another on one page: which is ahead, in which cases they differ, what would change the order.
import { setSetting } from "../../actions";
import { columnOf } from "../../columns";
import { type Aim, type Decision, decide, hasDraws } from "../../decision";
import { card, choose, el, field } from "../../dom";
import { count, shortened } from "../../format";
import { groupingOf } from "../../grouping";
import type { Store } from "../../store";
import { byRank, createModel, type Model, nameOf } from "../designs/model";
import { aggregated } from "../designs/values";
import { positionOf } from "../shared/runs";
import type { View } from "../view";
import { assumedText, casesTable, effectsTable, sidesTable, totalsTable } from "./tables";
import { certaintyOf, changesOf, orderOf } from "./words";

const SETTING = "pair.designs";
const MOST_LISTED = 300;
const MOST_NAME = 110;

export const pairView: View = {
  name: "pair",
  title: "A against B",
  suits: (study) => study.size > 0 && study.requirements.length > 0 && groupingOf(study).size > 1,
  create(store) {
    const model = createModel(store);
    const take = (first: number, second: number): void => {
      const numbers = [first, second].map((design) => store.study.number[model.grouping.first[design]!]!);
      setSetting(store, SETTING, numbers.join());
    };
    const one = choose([], "", (value) => take(Number(value), chosenOf(model)[1]));
    const other = choose([], "", (value) => take(chosenOf(model)[0], Number(value)));
    [one.id, other.id] = ["pair-first", "pair-second"];
    const turn = (): void => {
      const [first, second] = chosenOf(model);
      take(second, first);
    };
    const swap = el("button", { id: "pair-swap", type: "button", click: turn }, "Swap");
    const every = el("input", { id: "pair-all", type: "checkbox", change: () => draw() }) as HTMLInputElement;
    const left = el("p", { class: "hint" });
    const choice = el("div", {});
    const cases = el("div", {});
    const below = el("div", { class: "pair-rest" });
    const controls = el(
      "div",
      { class: "controls" },
      el("div", { class: "row" }, field("A", one), field("B", other), swap),
    );
    const alike = el("label", { class: "check" }, every, " Cases in which they are alike, too");
    let listed = "";
    const draw = (): void => {
      const [first, second] = chosenOf(model);
      const designs = listedOf(model, first, second);
      // What the reader types into a list must find it as it was.
      if (designs.join() !== listed)
        for (const select of [one, other]) select.replaceChildren(...optionsOf(model, designs));
      listed = designs.join();
      [one.value, other.value] = [String(first), String(second)];
      const rest = model.grouping.size - designs.length;
      left.textContent = rest ? `${count(rest, "more design")} can be picked in the leader board.` : "";
      const { study, state } = store;
      const aims = aimsOf(store);
      const decision = decide(study, state.thresholds, store.judgement(), aims, first, second);
      choice.replaceChildren(...outcomeOf(model, aims, decision, first, second));
      cases.replaceChildren(casesTable(store, decision, every.checked));
      below.replaceChildren(...effectsTable(study, decision), assumedText(model, first, second));
      totals.replaceChildren(totalsTable(store, decision));
      changes.replaceChildren(...changesOf(study, state.thresholds, aims, decision).map((text) => el("li", {}, text)));
    };
    const totals = el("div", {});
    const changes = el("ul", { id: "pair-changes" });
    let chosen = "";
    store.subscribe((state, changed) => {
      const now = `${state.settings[SETTING]} ${state.settings["designs.picked"]}`;
      if (changed.has("thresholds") || (changed.has("settings") && now !== chosen)) draw();
      chosen = now;
    });
    draw();
    const rule =
      "One bound or one objective changes at a time. The order is by missed verdicts, then by the objectives of the study, else by price.";
    return el(
      "div",
      { class: "pair" },
      card("pair-outcome", "The choice", controls, left, choice),
      card("pair-totals", "Requirements", totals),
      card("pair-changes", "What would change the order", changes, el("p", { class: "hint" }, rule)),
      ...(hasDraws(store.study)
        ? [
            card("pair-cases", "Case by case", el("div", { class: "controls" }, alike), cases),
            card("pair-effects", "What the difference depends on", below),
          ]
        : []),
    );
  },
};

/** What the study asks for, else its prices. */
export function aimsOf({ study }: Store): Aim[] {
  const prices = study.properties.flatMap(({ isPrice }, place) =>
    isPrice ? [{ column: `property.${place}`, maximize: false }] : [],
  );
  return (study.objectives.length ? study.objectives : prices).map(({ column, maximize }) => {
    const { title, unit, text, values } = columnOf(study, column)!;
    const own = aggregated(study, values, maximize ? "max" : "min");
    return { title, unit, text, maximize, value: (design) => own[design]! };
  });
}

/** As in the address, else the first two that are picked, else the two that miss the fewest requirements. */
function chosenOf(model: Model): [number, number] {
  const { store, grouping, choices } = model;
  const given = (store.state.settings[SETTING] ?? "").split(",").map((text) => positionOf(store.study, Number(text)));
  const [first, second] = [
    given,
    choices.picked.map((design) => grouping.first[design]!),
    byRank(model).map((d) => grouping.first[d]!),
  ]
    .map((runs) => runs.filter((run) => run >= 0).map((run) => grouping.of[run]!))
    .find((designs) => designs.length > 1)!;
  return [first!, second!];
}

function listedOf(model: Model, first: number, second: number): number[] {
  const listed = [first, second, ...model.choices.picked, ...byRank(model).slice(0, MOST_LISTED)];
  return [...new Set(listed)].sort((a, b) => a - b);
}

function optionsOf(model: Model, designs: number[]): HTMLElement[] {
  return designs.map((design) => el("option", { value: design }, shortened(nameOf(model, design), MOST_NAME)));
}

function outcomeOf(model: Model, aims: Aim[], decision: Decision, first: number, second: number): HTMLElement[] {
  return [
    el("p", { class: "verdict-line", id: "pair-order", role: "status" }, orderOf(aims, decision)),
    el("p", { id: "pair-certainty" }, certaintyOf(model.store.study, decision)),
    sidesTable(model, aims, decision, first, second),
  ];
}
