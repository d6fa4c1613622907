// Every run and every configuration: parallel coordinates and tables.
import { card, el } from "../dom";
import { createConfigurations } from "../panels/configurations";
import { createParallel } from "../panels/parallel";
import { createTable } from "../panels/table";
import { plotted } from "../plane/plane";
import type { View } from "./view";

export const runsView: View = {
  name: "runs",
  title: "Runs",
  suits: plotted,
  create(store) {
    const configurations = store.study.configurations.length > 1 ? [card("overview", "Configurations", createConfigurations(store))] : [];
    return el("div", { class: "wide" }, ...configurations, card("all", "All runs", createParallel(store), createTable(store)));
  },
};
