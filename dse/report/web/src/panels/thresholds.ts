// One row per bound: hatch, slider and number field, and how many runs pass.
import { scaleLinear } from "d3-scale";
import { el } from "../dom";
import { group, number, withUnit } from "../format";
import { paintSwatch } from "../plot/hatch";
import { colourOf } from "../plot/regions";
import { studyThresholds, type Store } from "../store";
import type { Column } from "../study";
import { palette } from "../theme";
import { FAIL, NOT_EXERCISED, PASS, tally } from "../verdicts";
import { scope } from "./summary";

type Bound = "atMost" | "atLeast";

interface Row {
  requirement: number;
  bound: Bound;
  swatch: HTMLCanvasElement;
  slider: HTMLInputElement;
  field: HTMLInputElement;
  result: HTMLElement;
}

export function createThresholds(store: Store): HTMLElement {
  const rows: Row[] = [];
  const reset = el(
    "button",
    { id: "reset-thresholds", type: "button", click: () => store.set({ thresholds: studyThresholds(store.study) }) },
    "Reset to the study\u2019s",
  );
  const box = el("div", { class: "thresholds" });
  store.study.requirements.forEach((requirement, index) => {
    for (const bound of ["atLeast", "atMost"] as const) {
      if (requirement[bound] !== null) box.append(createRow(store, index, bound, rows));
    }
  });
  box.append(reset);

  const show = (swatches: boolean): void => {
    const { each } = store.judgement();
    const original = studyThresholds(store.study);
    for (const { requirement, bound, swatch, slider, field, result } of rows) {
      const value = store.state.thresholds[requirement]![bound]!;
      slider.value = String(value);
      if (document.activeElement !== field || Number(field.value) !== value) field.value = String(value);
      const { unit } = store.study.metrics[store.study.requirements[requirement]!.metric]!;
      slider.setAttribute("aria-valuetext", withUnit(number(value), unit));
      const counts = tally(store.study, each[requirement]!, scope(store));
      const judged = counts[PASS]! + counts[FAIL]!;
      const open = counts[NOT_EXERCISED]!;
      result.replaceChildren(
        el("b", {}, group(counts[PASS]!)),
        ` of ${group(judged)} pass`,
        el("span", { class: "muted" }, open ? `${group(open)} not exercised` : "all exercised"),
      );
      if (swatches) paintSwatch(swatch, requirement, colourOf(palette(), requirement));
    }
    reset.disabled = original.every(
      ({ atMost, atLeast }, index) =>
        atMost === store.state.thresholds[index]!.atMost && atLeast === store.state.thresholds[index]!.atLeast,
    );
  };
  show(true);
  store.subscribe((_, changed) => {
    if (changed.has("thresholds") || changed.has("theme") || changed.has("configuration")) show(changed.has("theme"));
  });
  return box;
}

function createRow(store: Store, requirement: number, bound: Bound, rows: Row[]): HTMLElement {
  const { title, metric, name } = store.study.requirements[requirement]!;
  const column = store.study.metrics[metric]!;
  const sign = bound === "atMost" ? "\u2264" : "\u2265";
  const id = `${bound}-${requirement}`;
  const set = (text: string): void => {
    const value = Number(text);
    if (text.trim() === "" || !Number.isFinite(value)) return;
    const thresholds = store.state.thresholds.slice();
    thresholds[requirement] = { ...thresholds[requirement]!, [bound]: value };
    store.set({ thresholds });
  };
  const { low, high, step } = reachOf(column, store.study.requirements[requirement]![bound]!);
  const slider = el("input", {
    id: `slider-${id}`,
    type: "range",
    min: low,
    max: high,
    step,
    "aria-label": `${title}: ${column.title} ${sign}`,
    input: () => set(slider.value),
  });
  const field: HTMLInputElement = el("input", {
    id: `field-${id}`,
    type: "number",
    step: "any",
    "aria-label": `${title}: ${column.title} ${sign}, in ${column.unit || "1"}`,
    input: () => set(field.value),
    blur: () => (field.value = String(store.state.thresholds[requirement]![bound])),
  });
  const swatch = el("canvas", { class: "swatch", "aria-hidden": "true" });
  const result = el("div", { class: "result", id: `result-${id}` });
  rows.push({ requirement, bound, swatch, slider, field, result });
  return el(
    "div",
    { class: "threshold" },
    swatch,
    el("div", { class: "name" }, el("b", { title: name }, title), el("span", { class: "muted" }, `${column.title} ${sign}`)),
    slider,
    el("div", { class: "entry" }, field, el("span", { class: "unit" }, column.unit)),
    result,
  );
}

// The slider spans the bulk of the metric's values and the study's own threshold, in round steps.
function reachOf({ values }: Column, threshold: number): { low: number; high: number; step: number } {
  const sorted = values.filter(Number.isFinite).sort();
  const at = (share: number): number => sorted[Math.round(share * (sorted.length - 1))] ?? threshold;
  const spread = at(0.95) - at(0.05) || Math.abs(threshold) || 1;
  const nice = scaleLinear([Math.min(at(0.01), threshold - 0.1 * spread), Math.max(at(0.95), threshold + 0.1 * spread)], [0, 1]).nice(20);
  const [low, high] = nice.domain() as [number, number];
  return { low, high, step: 10 ** Math.floor(Math.log10((high - low) / 400)) };
}
