// Every run and every configuration: parallel coordinates and tables.
import { addTools, card, el } from "../dom";
import { createConfigurations } from "../panels/configurations";
import { savingMenu } from "../panels/export";
import { createParallel } from "../panels/parallel";
import { createTable } from "../panels/table";
import { plotted } from "../plane/plane";
import type { View } from "./view";

export const runsView: View = {
  name: "runs",
  title: "Runs",
  suits: ({ size }) => size > 0,
  create(store) {
    const configurations =
      store.study.configurations.length > 1 && plotted(store.study)
        ? [card("overview", "Configurations", createConfigurations(store))]
        : [];
    const parallel = createParallel(store);
    const saved = {
      name: "runs",
      picture: parallel.picture,
      purpose: "Every run as a table, with DIR the study\u2019s folder:",
      command: () => "dse results DIR --format csv -o runs.csv",
    };
    const lines = addTools(card("lines", "Parallel coordinates", parallel.box), savingMenu(store, saved));
    return el("div", { class: "wide" }, lines, ...configurations, card("all", "All runs", createTable(store)));
  },
};
