// What the metrics depend on, and how sure the boundaries are: part by part, as runs of different planes are not mixed.
import { card, choose, el, field } from "../../dom";
import { group } from "../../format";
import type { Part, Response } from "../../insight";
import type { Store } from "../../store";
import { plotted } from "../../plane/plane";
import { planeName } from "../shared/planes";
import type { View } from "../view";
import { createBoxes } from "./boxes";
import { createChances } from "./chances";
import { createDependence } from "./dependence";
import { createMatrix } from "./matrix";
import { createProfiler } from "./profiler";
import { createSearch } from "./search";

export const understandingView: View = {
  name: "understanding",
  title: "Understanding",
  suits: ({ insight }) => insight !== null && insight.parts.some(({ factors }) => factors.length > 0),
  create(store) {
    const { study } = store;
    const { parts, chances, boxes, centres, search } = study.insight!;
    const told = parts.filter(({ factors }) => factors.length > 0);
    const dependence = el("div", {});
    const profiler = el("div", {});
    let part = told[0]!;
    let metric = part.responses[0]!.metric;
    const draw = (): void => {
      const response = part.responses.find((each) => each.metric === metric) ?? part.responses[0]!;
      dependence.replaceChildren(createDependence(store, part, response));
      profiler.replaceChildren(createProfiler(store, part, response));
    };
    const metrics = metricChoice(store, part, (value) => {
      metric = value;
      draw();
    });
    const partChoice = choose(told.map((each, index): [string, string] => [String(index), planeName(study, each.plane)]), "0", (value) => {
      part = told[Number(value)]!;
      note.textContent = noteOf(part);
      draw();
    });
    const note = el("p", { class: "hint" }, noteOf(part));
    const controls = el("div", { class: "controls" }, el("div", { class: "row" }, field("Metric", metrics), told.length > 1 && field("Runs in which were varied", partChoice)), note);
    draw();
    return el(
      "div",
      { class: "understanding" },
      card("dependence", "What a metric depends on", controls, dependence),
      card("profiler", "What would happen at other values", profiler),
      chances.length > 0 && card("chances", "How sure the boundaries are", createChances(store)),
      (boxes.length > 0 || centres.length > 0) && card("boxes", "Where all requirements are met", createBoxes(store)),
      plotted(study) && card("pairs", "All planes", createMatrix(store)),
      search && card("search", "How the search went", createSearch(store, search)),
    );
  },
};

function metricChoice({ study }: Store, part: Part, change: (metric: number) => void): HTMLSelectElement {
  const name = ({ metric }: Response): string => {
    const judged = study.requirements.some((requirement) => requirement.metric === metric);
    return study.metrics[metric]!.title + (judged ? " (required)" : "");
  };
  return choose(part.responses.map((each): [string, string] => [String(each.metric), name(each)]), String(part.responses[0]!.metric), (value) => change(Number(value)));
}

function noteOf({ runs, apart }: Part): string {
  return `Of ${group(runs)} runs${apart ? `; ${group(apart)} others, in which other variables were varied, are left out` : ""}.`;
}
