// All runs, sorted and filtered; only the rows in view exist, so that a hundred thousand cost no more than thirty.
import { selectRun, togglePin } from "../actions";
import { columnsOf } from "../columns";
import { countMarks } from "../counts";
import { el } from "../dom";
import { group } from "../format";
import type { Filter, Store } from "../store";
import { axisLabel, type Study } from "../study";
import { CLASSES, SIGNS, WORDS } from "../verdicts";
import { createHeading } from "./heading";

const ROW = 28;
const SPARE = 12;

interface Column {
  key: string;
  title: string;
  numeric: boolean;
  sort: (run: number) => number;
  text: (run: number) => string;
  marks: ((run: number) => number) | null;
}

export function createTable(store: Store): HTMLElement {
  const columns = tableColumns(store);
  const head = el("tr");
  const body = el("tbody");
  const table = el("table", { class: "runs", "aria-label": "All runs" }, el("thead", {}, head), body);
  const view = el(
    "div",
    { class: "view", tabindex: 0, "aria-label": "Run table; up and down arrows move the selection" },
    table,
  );
  const filters = el("div", { class: "tabs", role: "group", "aria-label": "Runs shown" });
  let runs = new Int32Array(0);

  const rows = (): void => {
    const start = Math.max(0, Math.floor(view.scrollTop / ROW) - SPARE);
    const end = Math.min(runs.length, Math.ceil((view.scrollTop + view.clientHeight) / ROW) + SPARE);
    body.replaceChildren(
      gap(start, columns.length),
      ...Array.from(runs.subarray(start, end), (run) => rowOf(store, columns, run)),
      gap(runs.length - end, columns.length),
    );
    table.setAttribute("aria-rowcount", String(runs.length + 1));
  };
  const showHead = createHead(store, columns, head);
  const order = (): void => {
    runs = arrange(store, columns);
    showHead();
    drawFilters(store, filters);
    rows();
  };
  const reveal = (): void => {
    const place = runs.indexOf(store.state.selected);
    if (place < 0) return;
    const top = place * ROW;
    if (top < view.scrollTop || top > view.scrollTop + view.clientHeight - 3 * ROW)
      view.scrollTop = top - view.clientHeight / 2 + ROW;
  };

  view.addEventListener("scroll", rows, { passive: true });
  view.addEventListener("keydown", (event) => {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (event.key === "p" && event.target === view) togglePin(store, store.state.selected);
    if (!step || !runs.length) return;
    event.preventDefault();
    const place = runs.indexOf(store.state.selected);
    selectRun(store, runs[Math.min(runs.length - 1, Math.max(0, place + step))]!);
  });
  new ResizeObserver(rows).observe(view);
  store.subscribe((_, changed) => {
    const judged = changed.has("thresholds");
    const ordered = store.state.filter !== "all" || store.state.sort.column === "verdict";
    if (changed.has("filter") || changed.has("sort") || changed.has("brushes") || (judged && ordered)) order();
    else if (judged || changed.has("selected") || changed.has("pins")) rows();
    if (judged) drawFilters(store, filters);
    if (changed.has("selected")) reveal();
  });
  order();
  requestAnimationFrame(reveal);
  return el("div", { class: "table" }, filters, view);
}

function tableColumns(store: Store): Column[] {
  const { study } = store;
  const columns: Column[] = [
    {
      key: "run",
      title: "Run",
      numeric: true,
      sort: (run) => study.number[run]!,
      text: (run) => String(study.number[run]),
      marks: null,
    },
  ];
  if (study.configurations.length > 1) {
    columns.push({
      key: "configuration",
      title: "Configuration",
      numeric: false,
      sort: (run) => study.configuration[run]!,
      text: (run) => study.configurations[study.configuration[run]!]!.id,
      marks: null,
    });
  }
  for (const { key, values, text, ...column } of columnsOf(study)) {
    const [group, index] = key.split(".") as [string, string];
    const judged = group === "metric" ? requirementOf(study, Number(index)) : -1;
    const lack = group === "variable" ? study.variables[Number(index)]!.lack : [];
    columns.push({
      key,
      title: axisLabel(column),
      numeric: true,
      sort: (run) => values[run]!,
      text: (run) =>
        lack.includes(study.configuration[run]!) || (group === "metric" && !study.done[run])
          ? "\u2013"
          : text(values[run]!),
      marks: judged < 0 ? null : (run) => store.judgement().each[judged]![run]!,
    });
  }
  columns.push({
    key: "verdict",
    title: "Verdict",
    numeric: false,
    sort: (run) => store.judgement().overall[run]!,
    text: (run) => WORDS[store.judgement().overall[run]!]!,
    marks: (run) => store.judgement().overall[run]!,
  });
  return columns;
}

function requirementOf(study: Study, metric: number): number {
  return study.requirements.findIndex((requirement) => requirement.metric === metric);
}

function arrange(store: Store, columns: Column[]): Int32Array<ArrayBuffer> {
  const { study, state } = store;
  const { overall } = store.judgement();
  const within = store.within();
  const found: number[] = [];
  for (let run = 0; run < study.size; run++) {
    if (state.filter !== "all" && overall[run] !== state.filter) continue;
    if (!within || within[run]) found.push(run);
  }
  const column = columns.find(({ key }) => key === state.sort.column) ?? columns[0]!;
  const keys = new Float64Array(study.size);
  for (const run of found) keys[run] = column.sort(run);
  const direction = state.sort.descending ? -1 : 1;
  found.sort((a, b) => {
    const [x, y] = [keys[a]!, keys[b]!];
    // What is undefined goes last, whichever way the column is sorted.
    if (Number.isNaN(x) || Number.isNaN(y)) return Number(Number.isNaN(x)) - Number(Number.isNaN(y));
    return x < y ? -direction : x > y ? direction : a - b;
  });
  return Int32Array.from(found);
}

/** Fills *head*; what it gives back shows how the table is sorted, and what is brushed. */
function createHead(store: Store, columns: Column[], head: HTMLElement): () => void {
  const cells = columns.map(({ key, title, numeric }) => {
    const arrow = el("span", { class: "arrow", "aria-hidden": "true" });
    const sort = (): void => {
      const { column, descending } = store.state.sort;
      store.set({ sort: { column: key, descending: column === key && !descending } });
    };
    const heading = createHeading(store, key);
    const cell = el(
      "th",
      { scope: "col", class: numeric ? "numeric" : "" },
      el("button", { type: "button", "data-sort": key, click: sort }, title, arrow),
      heading?.element,
    );
    return { key, arrow, heading, cell };
  });
  head.replaceChildren(...cells.map(({ cell }) => cell));
  return () => {
    const { column, descending } = store.state.sort;
    for (const { key, arrow, heading, cell } of cells) {
      cell.setAttribute("aria-sort", column !== key ? "none" : descending ? "descending" : "ascending");
      arrow.textContent = column !== key ? "" : descending ? "\u25be" : "\u25b4";
      heading?.show();
    }
  };
}

function drawFilters(store: Store, box: HTMLElement): void {
  const counts = countMarks(store.judgement().overall, null, store.within());
  const total = counts.reduce((sum, value) => sum + value, 0);
  const options: [Filter, string, number][] = [
    ["all", "all", total],
    ...([0, 1, 2, 3] as const).map((mark): [Filter, string, number] => [mark, WORDS[mark], counts[mark]!]),
  ];
  const focused = (document.activeElement as HTMLElement | null)?.id;
  box.replaceChildren(
    ...options.map(([filter, word, count]) =>
      el(
        "button",
        {
          id: `filter-${filter}`,
          type: "button",
          "aria-pressed": String(store.state.filter === filter),
          click: () => store.set({ filter }),
        },
        word,
        el("span", { class: "count" }, group(count)),
      ),
    ),
  );
  if (focused?.startsWith("filter-")) document.getElementById(focused)?.focus();
}

function rowOf(store: Store, columns: Column[], run: number): HTMLElement {
  const selected = store.state.selected === run;
  return el(
    "tr",
    {
      class: selected ? "chosen" : store.state.pins.includes(run) ? "pinned" : "",
      "aria-selected": String(selected),
      click: (event: MouseEvent) => (event.shiftKey ? togglePin(store, run) : selectRun(store, run)),
      pointerenter: () => store.set({ hovered: run }),
      pointerleave: () => store.set({ hovered: -1 }),
    },
    ...columns.map(({ key, numeric, text, marks }) => {
      const mark = marks?.(run);
      const kind = mark === undefined ? "" : CLASSES[mark]!;
      const shown = key === "verdict" ? `${SIGNS[mark!]} ${text(run)}` : text(run);
      return el("td", { class: `${numeric ? "numeric" : key} ${kind}` }, shown);
    }),
  );
}

function gap(count: number, columns: number): HTMLElement {
  const row = el("tr", { class: "gap", "aria-hidden": "true" }, el("td", { colspan: columns }));
  row.style.height = `${count * ROW}px`;
  if (!count) row.hidden = true;
  return row;
}
