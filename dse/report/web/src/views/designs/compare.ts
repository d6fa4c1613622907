// Two to five designs side by side: choices, properties, metrics with the best marked, margins, waveforms, pictures.
import { selectRun } from "../../actions";
import { el } from "../../dom";
import { badge } from "../../panels/selected";
import { axisLabel } from "../../study";
import { CLASSES, FAIL, PASS, SIGNS } from "../../verdicts";
import { marginWithShare } from "../shared/margins";
import { createArchitectures } from "./architecture";
import { seriesColour } from "./colouring";
import { short } from "./ellipsis";
import { choiceAt, configurationOf, hasVariable, MOST_COMPARED, type Model, nameOf, togglePick } from "./model";
import { createOverlay } from "./overlay";
import { designColumns } from "./values";

export function createCompare(model: Model): HTMLElement {
  const { store } = model;
  const table = el("div", { class: "scroll" });
  const hint = el("p", { class: "muted" });
  const pins = el(
    "button",
    {
      type: "button",
      id: "take-pins",
      click: () =>
        model.set({
          picked: [...new Set(store.state.pins.map((run) => model.grouping.of[run]!))].slice(0, MOST_COMPARED),
        }),
    },
    "Take the pinned runs",
  );
  const more = el("div", {}, ...(store.study.figures.length ? [createOverlay(model)] : []), createArchitectures(model));
  const draw = (): void => {
    const { picked } = model.choices;
    pins.hidden = !store.state.pins.length;
    hint.hidden = picked.length > 1;
    hint.textContent = picked.length
      ? "Pick a second design."
      : "Tick two to five designs in the leader board to see them side by side.";
    more.hidden = !picked.length;
    table.replaceChildren(...(picked.length ? [tableOf(model)] : []));
  };
  model.subscribe((changed) => {
    if (["picked", "pins", "criteria", "demand", "thresholds", "theme"].some((key) => changed.has(key as "picked")))
      draw();
  });
  draw();
  return el("div", { id: "comparing" }, hint, pins, el("div", { class: "comparing" }, table, more));
}

function tableOf(model: Model): HTMLElement {
  const { picked } = model.choices;
  const head = picked.map((design, index) => {
    const swatch = el("span", { class: "dot" });
    swatch.style.background = seriesColour(index);
    const name = el(
      "button",
      { type: "button", class: "link", click: () => selectRun(model.store, model.standing().deciding[design]!) },
      nameOf(model, design),
    );
    const drop = el(
      "button",
      {
        type: "button",
        class: "drop",
        "aria-label": `Take ${nameOf(model, design)} away`,
        click: () => togglePick(model, design),
      },
      "\u00d7",
    );
    return el(
      "th",
      { scope: "col" },
      el("span", { class: "named" }, swatch, name, drop),
      badge(model.standing().mark[design]!),
    );
  });
  return el(
    "table",
    { class: "compare", id: "compare" },
    el("thead", {}, el("tr", {}, el("td", {}), ...head)),
    ...choiceRows(model),
    ...numberRows(model),
    ...marginRows(model),
  );
}

function group(title: string, rows: HTMLElement[], columns: number): HTMLElement[] {
  return rows.length
    ? [
        el(
          "tbody",
          {},
          el("tr", { class: "group" }, el("th", { scope: "rowgroup", colspan: columns + 1 }, title)),
          ...rows,
        ),
      ]
    : [];
}

/** Those that differ; the number of those that do not. */
function choiceRows(model: Model): HTMLElement[] {
  const { store, choices } = model;
  const { study } = store;
  const configurations = choices.picked.map((design) => configurationOf(model, design));
  const places = [
    ...new Set(configurations.flatMap((one) => study.configurations[one]!.choices.map(([name]) => name))),
  ];
  const differing = places.filter((name) =>
    configurations.some((one) => choiceAt(store, one, name) !== choiceAt(store, configurations[0]!, name)),
  );
  const shown = differing.length ? differing : places;
  const rows = shown.map((name) =>
    el(
      "tr",
      {},
      el("th", { scope: "row" }, short(name)),
      ...configurations.map((one) => el("td", {}, short(choiceAt(store, one, name) || "\u2013"))),
    ),
  );
  const alike = places.length - differing.length;
  const title = !differing.length ? "Choices (all alike)" : alike ? `Choices (${alike} more are alike)` : "Choices";
  return group(title, rows, configurations.length);
}

function numberRows(model: Model): HTMLElement[] {
  const { store, choices } = model;
  const titles: [string, string][] = [
    ["variable", "Design variables"],
    ["property", "Properties"],
    ["composite", "Objectives"],
    ["metric", model.grouping.size < store.study.size ? "Metrics, at the worst condition" : "Metrics"],
  ];
  const columns = designColumns(store.study);
  return titles.flatMap(([kind, title]) => {
    const rows = columns.filter(({ key }) => key.startsWith(`${kind}.`)).map(({ key }) => numberRow(model, key));
    return group(title, rows, choices.picked.length);
  });
}

function numberRow(model: Model, key: string): HTMLElement {
  const { picked } = model.choices;
  const column = model.column(key);
  // A value that no run was exercised for is no better than another.
  const counts = picked.map((design) => hasVariable(model, key, design) && isShown(model, key, design));
  const known = picked
    .map((design, index) => (counts[index] ? column.values[design]! : NaN))
    .filter((value) => !Number.isNaN(value));
  const best = column.sense === "max" ? Math.max(...known) : Math.min(...known);
  // Nothing is better that nobody asked for.
  const isAim = model.choices.criteria.some((criterion) => criterion.column === key);
  const tells = isAim && known.length > 1 && known.some((value) => column.text(value) !== column.text(best));
  const cells = picked.map((design, index) => {
    const value = column.values[design]!;
    if (!hasVariable(model, key, design) || Number.isNaN(value)) return el("td", {}, "\u2013");
    // What reads alike is alike.
    const isBest = tells && counts[index]! && column.text(value) === column.text(best);
    const range = column.sense === "" ? rangeOf(model, key, design) : "";
    return el(
      "td",
      { class: isBest ? "best" : "" },
      range || column.text(value),
      isBest && el("span", { class: "unseen" }, " (best)"),
    );
  });
  const arrow = !isAim ? "" : column.sense === "max" ? " \u2191" : " \u2193";
  return el("tr", {}, el("th", { scope: "row" }, axisLabel(column) + arrow), ...cells);
}

function isShown({ store, standing }: Model, key: string, design: number): boolean {
  const { each } = standing();
  return store.study.requirements.every(
    ({ metric }, index) => `metric.${metric}` !== key || each[index]![design] === PASS || each[index]![design] === FAIL,
  );
}

/** From the least to the greatest of a design's runs, where nobody says which way is worse; "" if they are alike. */
function rangeOf({ grouping, store }: Model, key: string, design: number): string {
  if (!key.startsWith("metric.")) return "";
  const { values, text } = store.study.metrics[Number(key.slice("metric.".length))]!;
  let [low, high] = [Infinity, -Infinity];
  for (const run of grouping.rows.subarray(grouping.start[design]!, grouping.start[design + 1]!)) {
    low = Math.min(low, values[run]!);
    high = Math.max(high, values[run]!);
  }
  return low < high ? `${text(low)} \u2026 ${text(high)}` : "";
}

function marginRows(model: Model): HTMLElement[] {
  const { store, choices } = model;
  const { study, state } = store;
  const { each, margins } = model.standing();
  const rows = study.requirements.map(({ title }, index) => {
    const threshold = state.thresholds[index]!;
    const cells = choices.picked.map((design) => {
      const by = margins[index]![design]!;
      const mark = each[index]![design]!;
      const text = Number.isNaN(by) ? "\u2013" : marginWithShare(study, index, threshold, by);
      return el("td", { class: CLASSES[mark]! }, `${SIGNS[mark]} ${text}`);
    });
    return el(
      "tr",
      { class: threshold.off ? "off" : "" },
      el("th", { scope: "row" }, title + (threshold.off ? " (off)" : "")),
      ...cells,
    );
  });
  return group("Margins of the requirements", rows, choices.picked.length);
}
