// Designs: which one to take, why another is out, and what would have to change.
import { addTools, card, el } from "../../dom";
import { groupingOf } from "../../grouping";
import type { View } from "../view";
import { createAlternatives } from "./alternatives";
import { createCompare } from "./compare";
import { createCriteria } from "./criteria";
import { boardButton, scatterMenu } from "./export";
import { createFunnel } from "./funnel";
import { createLeaderboard } from "./leaderboard";
import { createModel, differingPlaces } from "./model";
import { createReasons } from "./reasons";
import { createScatter } from "./scatter";
import { designColumns } from "./values";
import { createWaterfall } from "./waterfall";

export const designsView: View = {
  name: "designs",
  title: "Designs",
  suits: (study) => study.size > 0 && designColumns(study).length > 0,
  create(store) {
    const root = el("div", { class: "designs" });
    const model = createModel(store);
    const scatter = createScatter(model);
    const several = groupingOf(store.study).size > 1;
    const boxes = differingPlaces(store).length
      ? [card("buys", "What an alternative buys", createAlternatives(model))]
      : [];
    const falls =
      several && store.study.requirements.length
        ? [card("falls", "What requirements leave", createWaterfall(model))]
        : [];
    const { notes } = store.study;
    const left = notes?.funnel?.steps.length
      ? [card("static", "What the design space leaves", createFunnel(store.study, notes.funnel))]
      : [];
    root.append(
      el(
        "div",
        { class: "left" },
        addTools(card("scatter", "Any over any", scatter.box), scatterMenu(model, scatter.picture)),
      ),
      el(
        "div",
        { class: "right" },
        card("asked", "What is asked of a design", createCriteria(model)),
        card("why", "The selected design", createReasons(model)),
      ),
      el(
        "div",
        { class: "wide" },
        addTools(card("board", "Leader board", createLeaderboard(model)), boardButton(model)),
        ...(several ? [card("side", "Side by side", createCompare(model))] : []),
        ...falls,
        ...left,
        ...boxes,
      ),
    );
    return root;
  },
};
