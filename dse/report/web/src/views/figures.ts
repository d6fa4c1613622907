// Figures that were drawn by Python, of this program and of others.
import { card, el } from "../dom";
import { createCharts } from "../panels/charts";
import { withSaving } from "../panels/export";
import type { View } from "./view";

export const figuresView: View = {
  name: "figures",
  title: "Figures",
  suits: (study) => study.charted.length > 0,
  create: (store) =>
    el("div", { class: "wide" }, withSaving(store, card("charts", "Figures", createCharts(store)), "figures", "")),
};
