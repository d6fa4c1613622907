// What the metrics depend on, and how sure the boundaries are: part by part, as runs of different planes are not mixed.
import { card, choose, el, field } from "../../dom";
import { group } from "../../format";
import type { Part, Response } from "../../insight";
import { withSaving } from "../../panels/export";
import { plotted } from "../../plane/plane";
import { type Store, untilDropped } from "../../store";
import { planeName } from "../shared/planes";
import type { View } from "../view";
import { createBoxes } from "./boxes";
import { createAround } from "./centre";
import { createChances } from "./chances";
import { createDependence } from "./dependence";
import { createMatrix } from "./matrix";
import { createProfiler } from "./profiler";
import { createSearch } from "./search";
import { chooseMetric, choosePart, subjectOf } from "./selection";

export const understandingView: View = {
  name: "understanding",
  title: "Understanding",
  suits: ({ insight }) => insight?.parts.some(({ factors }) => factors.length > 0) ?? false,
  create(store) {
    const { study } = store;
    const { parts, chances, boxes, centres, search } = study.insight!;
    const told = parts.filter(({ factors }) => factors.length > 0);
    const dependence = el("div", {});
    const profiler = el("div", {});
    let subject = subjectOf(store, told);
    let drop = (): void => undefined;
    const metrics = el("select", {
      id: "understood-metric",
      change: () => chooseMetric(store, Number(metrics.value), subject),
    });
    const partChoice = choose(
      told.map((each, index): [string, string] => [String(index), planeName(study, each.plane)]),
      "0",
      (value) => choosePart(store, Number(value)),
    );
    partChoice.id = "understood-part";
    const note = el("p", { class: "hint" });
    const controls = el(
      "div",
      { class: "controls" },
      el(
        "div",
        { class: "row" },
        field("Metric", metrics),
        told.length > 1 && field("Runs in which were varied", partChoice),
      ),
      note,
    );
    const draw = (): void => {
      const { part, response } = subject;
      drop();
      const scope = untilDropped(store);
      drop = scope.drop;
      metrics.replaceChildren(
        ...part.responses.map((each) => el("option", { value: each.metric }, metricName(store, each))),
      );
      metrics.value = String(response.metric);
      partChoice.value = String(told.indexOf(part));
      note.textContent = noteOf(part);
      dependence.replaceChildren(createDependence(scope.store, part, response));
      profiler.replaceChildren(createProfiler(scope.store, part, response));
    };
    draw();
    store.subscribe((_, changed) => {
      if (!changed.has("settings")) return;
      const now = subjectOf(store, told);
      if (now.part === subject.part && now.response === subject.response) return;
      subject = now;
      draw();
    });
    return el(
      "div",
      { class: "understanding" },
      withSaving(store, card("dependence", "What a metric depends on", controls, dependence), "effects", "effects"),
      withSaving(store, card("profiler", "What would happen at other values", profiler), "profile", ""),
      chances.length > 0 &&
        withSaving(
          store,
          card("chances", "How sure the boundaries are", createChances(store), createAround(store)),
          "boundaries",
          "boundary",
        ),
      (boxes.length > 0 || centres.length > 0) && card("boxes", "Where all requirements are met", createBoxes(store)),
      plotted(study) && withSaving(store, card("pairs", "All planes", createMatrix(store)), "planes", "constraints"),
      search &&
        withSaving(store, card("search", "How the search went", createSearch(store, search)), "search", "search"),
    );
  },
};

function metricName({ study }: Store, { metric }: Response): string {
  const judged = study.requirements.some((requirement) => requirement.metric === metric);
  return study.metrics[metric]!.title + (judged ? " (required)" : "");
}

function noteOf({ runs, apart }: Part): string {
  return `Of ${group(runs)} runs${apart ? `; ${group(apart)} others, in which other variables were varied, are left out` : ""}.`;
}
