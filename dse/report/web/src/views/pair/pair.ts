// One design against another on one page: which is ahead, in which cases they differ, what would change the order.
import { setSetting } from "../../actions";
import { columnOf } from "../../columns";
import { type Aim, decide, hasDraws } from "../../decision";
import { card, choose, el, field } from "../../dom";
import { shortened } from "../../format";
import { groupingOf } from "../../grouping";
import type { Store } from "../../store";
import { createModel, type Model, nameOf } from "../designs/model";
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
    const root = el("div", { class: "pair" });
    let chosen = "";
    let all = false;
    const take = (first: number, second: number): void => {
      const numbers = [first, second].map((design) => store.study.number[model.grouping.first[design]!]!);
      setSetting(store, SETTING, numbers.join());
    };
    const draw = (): void => {
      const [first, second] = chosenOf(model);
      const focused = (document.activeElement as HTMLElement | null)?.id;
      root.replaceChildren(
        ...cardsOf(model, first, second, take, all, (now) => {
          all = now;
          draw();
        }),
      );
      if (focused && root.querySelector(`[id="${focused}"]`)) document.getElementById(focused)!.focus();
    };
    store.subscribe((state, changed) => {
      const now = `${state.settings[SETTING]} ${state.settings["designs.picked"]}`;
      if (changed.has("thresholds") || (changed.has("settings") && now !== chosen)) draw();
      chosen = now;
    });
    draw();
    return root;
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

function byRank(model: Model): number[] {
  const { missed, slack } = model.standing();
  const key = (design: number): number => (Number.isNaN(slack[design]!) ? -Infinity : slack[design]!);
  return Array.from(missed.keys()).sort((a, b) => missed[a]! - missed[b]! || key(b) - key(a) || a - b);
}

function cardsOf(
  model: Model,
  first: number,
  second: number,
  take: (first: number, second: number) => void,
  all: boolean,
  show: (all: boolean) => void,
): HTMLElement[] {
  const { store } = model;
  const { study, state } = store;
  const aims = aimsOf(store);
  const decision = decide(study, state.thresholds, store.judgement(), aims, first, second);
  const listed = [...new Set([first, second, ...model.choices.picked, ...byRank(model).slice(0, MOST_LISTED)])];
  listed.sort((a, b) => a - b);
  const options = listed.map((design): [string, string] => [
    String(design),
    shortened(nameOf(model, design), MOST_NAME),
  ]);
  const one = choose(options, String(first), (value) => take(Number(value), second));
  const other = choose(options, String(second), (value) => take(first, Number(value)));
  [one.id, other.id] = ["pair-first", "pair-second"];
  const swap = el("button", { id: "pair-swap", type: "button", click: () => take(second, first) }, "Swap");
  const left = model.grouping.size - listed.length;
  const every = el("input", { id: "pair-all", type: "checkbox", change: () => show(!all) }) as HTMLInputElement;
  every.checked = all;
  return [
    card(
      "outcome",
      "The choice",
      el("div", { class: "controls" }, el("div", { class: "row" }, field("A", one), field("B", other), swap)),
      left > 0 && el("p", { class: "hint" }, `${left} more designs can be picked in the leader board.`),
      el("p", { class: "verdict-line", id: "pair-order", role: "status" }, orderOf(aims, decision)),
      el("p", { id: "pair-certainty" }, certaintyOf(study, decision)),
      sidesTable(model, aims, decision, first, second),
    ),
    card("totals", "Requirements", totalsTable(store, decision)),
    card(
      "changes",
      "What would change the order",
      el(
        "ul",
        { id: "pair-changes" },
        ...changesOf(study, state.thresholds, aims, decision).map((text) => el("li", {}, text)),
      ),
      el(
        "p",
        { class: "hint" },
        "One bound or one objective changes at a time. The order is by missed verdicts, then by the objectives of the study, else by price.",
      ),
    ),
    ...(hasDraws(study)
      ? [
          card(
            "cases",
            "Case by case",
            el(
              "div",
              { class: "controls" },
              el("label", { class: "check" }, every, " Cases in which they are alike, too"),
            ),
            casesTable(store, decision, all),
          ),
          card(
            "effects",
            "What the difference depends on",
            ...effectsTable(study, decision),
            assumedText(model, first, second),
          ),
        ]
      : []),
  ];
}
