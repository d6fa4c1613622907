// What is brushed, on every view: a chip for each range, how many runs lie within, and what to do with them.

import { type Brush, rebrushed } from "../brush";
import { columnOf, columnsOf } from "../columns";
import { countMarks } from "../counts";
import { choose, el } from "../dom";
import { group, number, withUnit } from "../format";
import { createMenu } from "../menu";
import { copyText, csvOf, download } from "../save";
import type { Store } from "../store";
import { axisLabel } from "../study";
import { PASS } from "../verdicts";
import { nextStudy } from "../yaml";

/** The chips, hidden while nothing is brushed, and a form that brushes without a mouse. */
export function createBrushes(store: Store): { chips: HTMLElement; form: HTMLElement } {
  const chips = el("section", { class: "brushes", "aria-label": "Brushed ranges", hidden: true });
  const draw = (): void => {
    const { brushes } = store.state;
    chips.hidden = !brushes.length;
    if (!brushes.length) return chips.replaceChildren();
    const focused = document.activeElement?.id;
    const { runs, within, judgement, noun } = store.designs();
    const counts = countMarks(judgement.overall, runs, within);
    const total = counts.reduce((sum, value) => sum + value, 0);
    chips.replaceChildren(
      ...brushes.map((brush) => chip(store, brush)),
      el(
        "span",
        { id: "within" },
        el("b", {}, group(total)),
        ` of ${group(runs.length)} ${noun}s within, ${group(counts[PASS]!)} pass`,
      ),
      el("span", { class: "spring" }),
      ...(store.study.variables.length ? [nextMenu(store)] : []),
      el(
        "button",
        {
          type: "button",
          id: "save-within",
          click: () => download("runs.csv", new Blob([csvOf(store)], { type: "text/csv" })),
        },
        "Runs (CSV)",
      ),
      el("button", { type: "button", id: "clear-brushes", click: () => store.set({ brushes: [] }) }, "Clear"),
    );
    if (focused) document.getElementById(focused)?.focus();
  };
  draw();
  store.subscribe((_, changed) => {
    if (changed.has("brushes") || changed.has("thresholds")) draw();
  });
  return { chips, form: createForm(store) };
}

function chip(store: Store, { column, low, high }: Brush): HTMLElement {
  const { title, unit, text, names } = columnOf(store.study, column)!;
  const shown = (value: number): string => (names ? text(Math.round(value)) : number(value, 3));
  const remove = (): void => store.set({ brushes: rebrushed(store.state.brushes, column, null) });
  return el(
    "span",
    { class: "chip" },
    el("span", { class: "clip", title }, title),
    el("b", {}, withUnit(`${shown(low)} \u2026 ${shown(high)}`, unit)),
    el(
      "button",
      { class: "bare", type: "button", "aria-label": `Remove the range of ${title}`, click: remove },
      "\u00d7",
    ),
  );
}

function nextMenu(store: Store): HTMLElement {
  const text = nextStudy(store);
  const shown = el("pre", { id: "next-study", tabindex: 0 }, text);
  const said = el("span", { class: "muted", role: "status" });
  const copy = el(
    "button",
    {
      type: "button",
      click: () =>
        void copyText(text, shown).then((done) => (said.textContent = done ? "copied" : "selected: press Ctrl+C")),
    },
    "Copy",
  );
  return createMenu("next-summary", "As the next study", "As the next study", el("div", {}, shown, copy, said));
}

function createForm(store: Store): HTMLElement {
  const columns = columnsOf(store.study);
  if (!columns.length) return el("span");
  const low = el("input", { type: "number", step: "any", "aria-label": "from", id: "limit-low" });
  const high = el("input", { type: "number", step: "any", "aria-label": "to", id: "limit-high" });
  const fill = (key: string): void => {
    const brush = store.state.brushes.find(({ column }) => column === key);
    low.value = brush ? String(brush.low) : "";
    high.value = brush ? String(brush.high) : "";
  };
  const select = choose(
    columns.map((column) => [column.key, axisLabel(column)]),
    columns[0]!.key,
    fill,
  );
  select.id = "limit-column";
  select.setAttribute("aria-label", "Quantity");
  const apply = (event: Event): void => {
    event.preventDefault();
    // An end that is left empty is open.
    const end = (field: HTMLInputElement, open: number): number =>
      field.value.trim() === "" ? open : Number(field.value);
    const { values } = columnOf(store.study, select.value)!;
    const known = values.filter(Number.isFinite);
    const [least, most] = [
      known.reduce((a, b) => Math.min(a, b), Infinity),
      known.reduce((a, b) => Math.max(a, b), -Infinity),
    ];
    const range: [number, number] = [end(low, least), end(high, most)];
    if (range.every(Number.isFinite)) store.set({ brushes: rebrushed(store.state.brushes, select.value, range) });
    menu.open = false;
    menu.querySelector("summary")!.focus();
  };
  const form = el(
    "form",
    { id: "limit", submit: apply },
    el("label", { class: "field" }, el("span", {}, "Only runs whose"), select),
    el(
      "div",
      { class: "range" },
      el("span", { class: "muted" }, "from"),
      low,
      el("span", { class: "muted" }, "to"),
      high,
    ),
    el("button", { type: "submit" }, "Apply"),
    el("p", { class: "hint" }, "An empty end is open. Dragging along an axis does the same."),
  );
  const menu = createMenu("limit-runs", "Limit runs", "Limit runs", form, () => fill(select.value));
  return menu;
}
