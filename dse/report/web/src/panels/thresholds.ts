// One row per bound: a switch, slider and number field, how many runs pass, and how the selected run does.
import { scaleLinear } from "d3-scale";
import { countMarks, shownRuns } from "../counts";
import { el } from "../dom";
import { group, number, withUnit } from "../format";
import { paintSwatch } from "../plot/hatch";
import { colourOf } from "../plot/regions";
import { type State, type Store, studyThresholds } from "../store";
import { axisLabel, type Column } from "../study";
import { palette } from "../theme";
import { CLASSES, FAIL, margin, NOT_APPLICABLE, NOT_EXERCISED, PASS, SIGNS, WORDS } from "../verdicts";

type Bound = "atMost" | "atLeast";

interface Row {
  requirement: number;
  bound: Bound;
  box: HTMLElement;
  toggle: HTMLInputElement | null;
  swatch: HTMLCanvasElement;
  change: HTMLElement;
  slider: HTMLInputElement;
  field: HTMLInputElement;
  counts: HTMLElement;
  light: HTMLElement;
}

const COUNTED: (keyof State)[] = ["thresholds", "configuration", "x", "y", "fixed", "brushes"];

/** The rows, and the button that takes the thresholds back to the study's. */
export function createThresholds(store: Store): { box: HTMLElement; reset: HTMLElement } {
  const rows: Row[] = [];
  const reset = el(
    "button",
    { id: "reset-thresholds", type: "button", click: () => store.set({ thresholds: studyThresholds(store.study) }) },
    "Reset to the study\u2019s",
  );
  const box = el("div", { class: "thresholds" });
  store.study.requirements.forEach((requirement, index) => {
    const bounds = (["atLeast", "atMost"] as const).filter((bound) => requirement[bound] !== null);
    bounds.forEach((bound, order) => {
      const row = createRow(store, index, bound, order === 0);
      rows.push(row);
      box.append(row.box);
    });
  });

  const show = (): void => {
    for (const row of rows) showRow(store, row);
    reset.disabled = store.study.requirements.every(({ atMost, atLeast }, index) => {
      const threshold = store.state.thresholds[index]!;
      return atMost === threshold.atMost && atLeast === threshold.atLeast && !threshold.off;
    });
  };
  const paint = (): void => {
    const colours = palette();
    for (const { swatch, requirement } of rows) paintSwatch(swatch, requirement, colourOf(colours, requirement));
  };
  show();
  paint();
  store.subscribe((_, changed) => {
    if (COUNTED.some((key) => changed.has(key))) show();
    else if (changed.has("selected")) for (const row of rows) showLight(store, row);
    if (changed.has("theme")) paint();
  });
  return { box, reset };
}

function createRow(store: Store, requirement: number, bound: Bound, first: boolean): Row {
  const { title, metric, name } = store.study.requirements[requirement]!;
  const column = store.study.metrics[metric]!;
  const original = store.study.requirements[requirement]![bound]!;
  const sign = bound === "atMost" ? "\u2264" : "\u2265";
  const id = `${bound}-${requirement}`;
  const replace = (patch: Partial<State["thresholds"][number]>): void => {
    const thresholds = store.state.thresholds.slice();
    thresholds[requirement] = { ...thresholds[requirement]!, ...patch };
    store.set({ thresholds });
  };
  const set = (text: string): void => {
    const value = Number(text);
    if (text.trim() !== "" && Number.isFinite(value)) replace({ [bound]: value });
  };
  const toggle = first
    ? el("input", {
        id: `switch-${requirement}`,
        type: "checkbox",
        "aria-label": `${title} counts`,
        title: "Whether this requirement counts",
        change: (event: Event) => replace({ off: !(event.target as HTMLInputElement).checked }),
      })
    : null;
  const { low, high, step } = reachOf(column, original);
  // Where the study's own bound lies.
  const ticks = el("datalist", { id: `ticks-${id}` }, el("option", { value: original }));
  const slider = el("input", {
    id: `slider-${id}`,
    type: "range",
    min: low,
    max: high,
    step,
    list: `ticks-${id}`,
    "aria-label": `${title}: ${column.title} ${sign}`,
    input: () => set(slider.value),
  });
  const field: HTMLInputElement = el("input", {
    id: `field-${id}`,
    type: "number",
    step: "any",
    "aria-label": `${title}: ${column.title} ${sign}, in ${column.unit || "1"}`,
    input: () => set(field.value),
    blur: () => (field.value = written(store.state.thresholds[requirement]![bound]!)),
  });
  const swatch = el("canvas", { class: "swatch", "aria-hidden": "true" });
  const change = el("span", { class: "change" });
  const counts = el("div", { id: `result-${id}` });
  const light = el("div", { id: `light-${id}` });
  const box = el(
    "div",
    { class: "threshold" },
    toggle ?? el("span"),
    swatch,
    el(
      "div",
      { class: "name", title: `${name}: ${title}` },
      el("b", {}, title),
      el("span", { class: "muted" }, `${column.title} ${sign}`),
      change,
    ),
    el("div", { class: "reach" }, slider, ticks),
    el("div", { class: "entry" }, field, el("span", { class: "unit", title: axisLabel(column) }, column.unit)),
    el("div", { class: "result" }, counts, light),
  );
  return { requirement, bound, box, toggle, swatch, change, slider, field, counts, light };
}

function showRow(store: Store, row: Row): void {
  const { study, state } = store;
  const { requirement, bound, toggle, slider, field, counts } = row;
  const threshold = state.thresholds[requirement]!;
  const value = threshold[bound]!;
  const { unit } = study.metrics[study.requirements[requirement]!.metric]!;
  row.box.classList.toggle("off", !!threshold.off);
  if (toggle) toggle.checked = !threshold.off;
  slider.value = String(value);
  if (document.activeElement !== field || Number(field.value) !== Number(written(value))) field.value = written(value);
  slider.setAttribute("aria-valuetext", withUnit(number(value), unit));
  row.change.textContent = changed(study.requirements[requirement]![bound]!, value, bound, unit);
  const { judgement, within, noun } = store.points();
  const counted = countMarks(judgement.each[requirement]!, shownRuns(store), within);
  const open = counted[NOT_EXERCISED]!;
  if (counted[NOT_APPLICABLE] && !counted[PASS] && !counted[FAIL]) counts.replaceChildren("does not apply here");
  else counts.replaceChildren(el("b", {}, group(counted[PASS]!)), ` of ${group(counted[PASS]! + counted[FAIL]!)} pass`);
  counts.title = open ? `${group(open)} ${noun}s do not exercise it` : `every ${noun} exercises it`;
  showLight(store, row);
}

function showLight({ study, state, judgement }: Store, { requirement, light }: Row): void {
  const run = state.selected;
  if (run < 0) return light.replaceChildren();
  const metric = study.metrics[study.requirements[requirement]!.metric]!;
  const mark = judgement().each[requirement]![run]!;
  const by = margin(metric.values[run]!, state.thresholds[requirement]!);
  const text =
    mark <= FAIL && !Number.isNaN(by) ? withUnit(`${by > 0 ? "+" : ""}${number(by, 3)}`, metric.unit) : WORDS[mark]!;
  const shown = mark === NOT_APPLICABLE ? SIGNS[mark] : `${SIGNS[mark]} ${text}`;
  light.replaceChildren(
    el("span", { class: `badge ${CLASSES[mark]}`, title: `Run ${study.number[run]}: ${WORDS[mark]}` }, shown),
  );
}

// 3 times 0.2 is 0.6000000000000001; the last digits are no one's wish.
function written(value: number): string {
  return String(Number(value.toPrecision(12)));
}

// In words, how the bound differs from the study's.
function changed(original: number, value: number, bound: Bound, unit: string): string {
  if (value === original) return "";
  const tighter = bound === "atMost" ? value < original : value > original;
  return `${tighter ? "tightened" : "relaxed"} from ${withUnit(number(original), unit)}`;
}

// The slider spans the bulk of the metric's values and the study's own threshold, in round steps.
function reachOf({ values }: Column, threshold: number): { low: number; high: number; step: number } {
  const sorted = values.filter(Number.isFinite).sort();
  const at = (share: number): number => sorted[Math.round(share * (sorted.length - 1))] ?? threshold;
  const spread = at(0.95) - at(0.05) || Math.abs(threshold) || 1;
  const nice = scaleLinear(
    [Math.min(at(0.01), threshold - 0.1 * spread), Math.max(at(0.95), threshold + 0.1 * spread)],
    [0, 1],
  ).nice(20);
  const [low, high] = nice.domain() as [number, number];
  return { low, high, step: 10 ** Math.floor(Math.log10((high - low) / 400)) };
}
