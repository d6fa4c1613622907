// One design against another on one page: which is ahead, in which cases they differ, what would change the order.
import { setSetting } from "../../actions";
import { type Decision, decide, hasDraws } from "../../decision";
import { card, choose, el, field } from "../../dom";
import { count, shortened } from "../../format";
import { groupingOf } from "../../grouping";
import { type Aim, aimsOf, type DesignOrder, orderAt } from "../../order";
import { createModel, type Model, nameOf } from "../designs/model";
import { positionOf } from "../shared/runs";
import type { View } from "../view";
import { assumedList, assumedNumbers, casesTable, effectsTable, sidesTable, totalsTable } from "./tables";
import { certaintyOf, changesOf, orderSentence, orderText } from "./words";

/** The numbers of the first runs of A and B. */
export const SETTING = "pair.designs";
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
    const alike = el("label", { class: "check" }, every, " Verdicts in which they are alike, too");
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
      const [aims, order] = [aimsOf(study), orderAt(store)];
      const decision = decide(study, state.thresholds, store.judgement(), aims, order, first, second);
      choice.replaceChildren(...outcomeOf(model, aims, order, decision, first, second));
      rule.textContent = `One bound or one objective changes at a time. Order of designs: ${orderSentence(aims, order)}`;
      cases.replaceChildren(casesTable(store, decision, every.checked));
      below.replaceChildren(...effectsTable(study, decision), assumedList(study, assumedNumbers(model, first, second)));
      totals.replaceChildren(totalsTable(store, decision));
      changes.replaceChildren(
        ...changesOf(study, state.thresholds, aims, order, decision).map((text) => el("li", {}, text)),
      );
    };
    const totals = el("div", {});
    const changes = el("ul", { id: "pair-changes" });
    const rule = el("p", { class: "hint", id: "pair-rule" });
    let chosen = "";
    store.subscribe((state, changed) => {
      const now = `${state.settings[SETTING]} ${state.settings["designs.picked"]}`;
      if (changed.has("thresholds") || (changed.has("settings") && now !== chosen)) draw();
      chosen = now;
    });
    draw();
    return el(
      "div",
      { class: "pair" },
      card("pair-outcome", "The choice", controls, left, choice),
      card("pair-totals", "Requirements", totals),
      card("pair-changes", "What would change the order", changes, rule),
      ...(hasDraws(store.study)
        ? [
            card("pair-cases", "Verdict by verdict", el("div", { class: "controls" }, alike), cases),
            card("pair-effects", "What the difference depends on", below),
          ]
        : []),
    );
  },
};

/** As in the address, else the first two that are picked, else the first two in the order. */
function chosenOf(model: Model): [number, number] {
  const { store, grouping, choices } = model;
  const given = (store.state.settings[SETTING] ?? "").split(",").map((text) => positionOf(store.study, Number(text)));
  const [first, second] = [
    given,
    choices.picked.map((design) => grouping.first[design]!),
    Array.from(orderAt(store).ranked.subarray(0, 2), (design) => grouping.first[design]!),
  ]
    .map((runs) => runs.filter((run) => run >= 0).map((run) => grouping.of[run]!))
    .find((designs) => designs.length > 1)!;
  return [first!, second!];
}

function listedOf(model: Model, first: number, second: number): number[] {
  const listed = [first, second, ...model.choices.picked, ...orderAt(model.store).ranked.subarray(0, MOST_LISTED)];
  return [...new Set(listed)].sort((a, b) => a - b);
}

function optionsOf(model: Model, designs: number[]): HTMLElement[] {
  return designs.map((design) => el("option", { value: design }, shortened(nameOf(model, design), MOST_NAME)));
}

function outcomeOf(
  model: Model,
  aims: Aim[],
  order: DesignOrder,
  decision: Decision,
  first: number,
  second: number,
): HTMLElement[] {
  const text = orderText(aims, order, decision, [first, second]);
  return [
    el("p", { class: "verdict-line", id: "pair-order", role: "status" }, text),
    el("p", { id: "pair-certainty" }, certaintyOf(model.store.study, decision)),
    sidesTable(model, aims, order, decision, first, second),
  ];
}
