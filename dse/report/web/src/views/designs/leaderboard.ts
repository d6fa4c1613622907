// All designs as a table, in the order of designs or by any column; only the rows in view exist.
import { selectRun } from "../../actions";
import { el } from "../../dom";
import { aimsOf, missedText } from "../../order";
import { createHeading } from "../../panels/heading";
import { axisLabel } from "../../study";
import { CLASSES, SIGNS, wordFor } from "../../verdicts";
import { orderSentence } from "../pair/words";
import { SHARE_OF, shareText } from "../shared/margins";
import {
  choiceAt,
  configurationOf,
  differingPlaces,
  hasVariable,
  type Model,
  nameOf,
  subscribeCalmly,
  togglePick,
} from "./model";
import { designColumns, place } from "./values";

const ROW = 28;
const SPARE = 10;

interface Column {
  key: string;
  title: string;
  hint: string;
  numeric: boolean;
  value: (design: number) => number | string;
  text: (design: number) => string;
  mark?: (design: number) => number;
}

export function createLeaderboard(model: Model): HTMLElement {
  const { store } = model;
  const head = el("tr");
  const body = el("tbody");
  const table = el("table", { class: "runs", id: "leaders", "aria-label": "Designs" }, el("thead", {}, head), body);
  const view = el(
    "div",
    {
      class: "view",
      tabindex: 0,
      "aria-label": "Leader board; up and down arrows move the selection, space picks for comparison",
    },
    table,
  );
  const note = el("p", { class: "hint", id: "leaders-note" });
  let columns = columnsOf(model);
  let designs = new Int32Array(0);
  let headings: Headings = { of: "", show: () => undefined };

  const rows = (): void => {
    const start = Math.max(0, Math.floor(view.scrollTop / ROW) - SPARE);
    const end = Math.min(designs.length, Math.ceil((view.scrollTop + view.clientHeight) / ROW) + SPARE);
    const shown = Array.from(designs.subarray(start, end), (design, index) =>
      rowOf(model, columns, design, start + index),
    );
    const focused = (document.activeElement as HTMLElement | null)?.id;
    body.replaceChildren(gap(start, columns.length + 1), ...shown, gap(designs.length - end, columns.length + 1));
    if (focused?.startsWith("pick-")) document.getElementById(focused)?.focus({ preventScroll: true });
    table.setAttribute("aria-rowcount", String(designs.length + 1));
  };
  const order = (): void => {
    columns = columnsOf(model);
    designs = arranged(model, columns);
    headings = drawHead(model, columns, head, headings);
    note.textContent = noteOf(model, designs.length);
    rows();
  };
  const selected = (): number => (store.state.selected < 0 ? -1 : model.grouping.of[store.state.selected]!);
  view.addEventListener("scroll", rows, { passive: true });
  view.addEventListener("keydown", (event) => {
    if (event.target !== view || !designs.length) return;
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    const at = designs.indexOf(selected());
    if (event.key === " " && at >= 0) {
      event.preventDefault();
      togglePick(model, designs[at]!);
    }
    if (!step) return;
    event.preventDefault();
    const to = Math.min(designs.length - 1, Math.max(0, at + step));
    selectRun(store, model.standing().deciding[designs[to]!]!);
    const top = to * ROW;
    if (top < view.scrollTop || top > view.scrollTop + view.clientHeight - 3 * ROW)
      view.scrollTop = top - view.clientHeight / 2;
  });
  new ResizeObserver(rows).observe(view);
  const ordering = ["criteria", "demand", "thresholds", "brushes", "sort"] as const;
  subscribeCalmly(model, (changed) => {
    if (ordering.some((key) => changed.has(key))) order();
  });
  model.subscribe((changed) => {
    if ((changed.has("selected") || changed.has("picked")) && !ordering.some((key) => changed.has(key))) rows();
  });
  order();
  return el("div", { class: "leaders" }, view, note);
}

function columnsOf(model: Model): Column[] {
  const { store, choices } = model;
  const { study } = store;
  const { mark, each } = model.standing();
  const order = model.order();
  const scores = model.scores();
  const front = model.front();
  const aims = choices.criteria.map(({ column }) => column);
  const isScored = scores.some((score) => !Number.isNaN(score));
  const others = designColumns(study)
    .map(({ key }) => key)
    .filter((key) => !aims.includes(key));
  const kinds = ["property", "composite", "variable", "metric"];
  others.sort((a, b) => kinds.indexOf(a.split(".")[0]!) - kinds.indexOf(b.split(".")[0]!));
  const numeric = (key: string): Column => {
    const { title, unit, values, text, sense } = model.column(key);
    const judged = key.startsWith("metric.") ? study.requirements.findIndex(({ metric }) => metric === place(key)) : -1;
    const isMeasured = !/^(property|variable)\./.test(key) && model.grouping.size < study.size;
    const way = sense === "min" ? "largest" : sense === "max" ? "smallest" : "mean";
    const arrow = aims.includes(key) ? (sense === "max" ? " \u2191" : " \u2193") : "";
    return {
      key,
      title: `${isMeasured ? `${way}: ` : ""}${axisLabel({ title, unit })}${arrow}`,
      hint: !isMeasured
        ? ""
        : sense
          ? `Of each condition the mean over what is uncertain; of these means the ${way}. A single run may be worse`
          : "Over all its runs",
      numeric: true,
      value: (design) => (hasVariable(model, key, design) ? values[design]! : NaN),
      text: (design) =>
        !hasVariable(model, key, design) || Number.isNaN(values[design]!) ? "\u2013" : text(values[design]!),
      ...(judged >= 0 ? { mark: (design: number) => each[judged]![design]! } : {}),
    };
  };
  return [
    {
      key: "place",
      title: "Place",
      hint: orderSentence(aimsOf(study), order),
      numeric: true,
      value: (design) => order.place[design]!,
      text: (design) => `${order.place[design]! + 1}.`,
    },
    {
      key: "design",
      title: "Design",
      hint: "",
      numeric: false,
      value: (design) => design,
      text: (design) => nameOf(model, design),
    },
    ...(isScored
      ? [
          {
            key: "score",
            title: "Score",
            hint: "TOPSIS: 1 is the best of every criterion among the feasible designs, 0 the worst",
            numeric: true,
            value: (design: number) => scores[design]!,
            text: (design: number) => (Number.isNaN(scores[design]!) ? "\u2013" : scores[design]!.toFixed(3)),
          },
        ]
      : []),
    {
      key: "verdict",
      title: "Verdict",
      hint: "Of all its requirements at all conditions",
      numeric: false,
      value: (design) => mark[design]!,
      text: (design) => `${SIGNS[mark[design]!]} ${wordFor(mark[design]!, "design")}`,
      mark: (design) => mark[design]!,
    },
    ...(study.requirements.length
      ? [
          {
            key: "missed",
            title: "Missed verdicts",
            hint: "Verdicts on requirements at all conditions, by severity. Doubtful ones may change with more draws of what is uncertain, or with finer numerics",
            numeric: false,
            value: (design: number) => order.place[design]!,
            text: (design: number) => missedText(order, design),
          },
          {
            key: "slack",
            title: "Least margin [% of bound]",
            hint: `Of any requirement that is on, in the worst run; ${SHARE_OF}`,
            numeric: true,
            value: (design: number) => order.slack[design]!,
            text: (design: number) => shareText(order.slack[design]!),
          },
        ]
      : []),
    ...(isScored && aims.length > 1
      ? [
          {
            key: "front",
            title: "Front",
            hint: "On the Pareto front of the criteria, among the feasible designs",
            numeric: false,
            value: (design: number) => 1 - front[design]!,
            text: (design: number) => (front[design] ? "\u25cf" : ""),
          },
        ]
      : []),
    ...aims.map(numeric),
    ...differingPlaces(store).map((name): Column => {
      const chosen = (design: number): string => choiceAt(store, configurationOf(model, design), name) || "\u2013";
      return { key: `place.${name}`, title: name, hint: "", numeric: false, value: chosen, text: chosen };
    }),
    ...others.map(numeric),
  ];
}

/** By the column that is chosen; equal ones, and those without a value at the end, in the order of designs. */
function arranged(model: Model, columns: Column[]): Int32Array<ArrayBuffer> {
  const { ranked } = model.order();
  const within = model.within();
  const { sort } = model.choices;
  const found = ranked.filter((design) => within?.[design] ?? 1);
  const column = columns.find(({ key }) => key === sort.column);
  if (!column) return found;
  const direction = sort.descending ? -1 : 1;
  const keys = Array.from(ranked, (_, design) => column.value(design));
  const unknown = (key: number | string): boolean => typeof key === "number" && Number.isNaN(key);
  // What is undefined goes last, whichever way the column is sorted.
  return found.sort((a, b) => {
    const [x, y] = [keys[a]!, keys[b]!];
    if (unknown(x) || unknown(y)) return Number(unknown(x)) - Number(unknown(y));
    return x < y ? -direction : x > y ? direction : 0;
  });
}

interface Headings {
  /** The columns they were made for. */
  of: string;
  show: () => void;
}

/** Headings are made anew for other columns only: one may be dragged right now. */
function drawHead(model: Model, columns: Column[], head: HTMLElement, last: Headings): Headings {
  const of = JSON.stringify(columns.map(({ key, title }) => [key, title]));
  if (of === last.of) {
    last.show();
    return last;
  }
  const focused = (document.activeElement as HTMLElement | null)?.dataset.leader;
  const cells = columns.map(({ key, title, hint, numeric }) => {
    const arrow = el("span", { class: "arrow", "aria-hidden": "true" });
    const sort = (): void => {
      const { sort: now, criteria } = model.choices;
      // What is better when large is first shown largest first.
      const largest =
        key === "score" ||
        key === "slack" ||
        (numeric && criteria.some(({ column, maximize }) => column === key && maximize));
      model.set({ sort: { column: key, descending: now.column === key ? !now.descending : largest } });
    };
    const heading = createHeading(model.store, key);
    const cell = el(
      "th",
      { scope: "col", class: numeric ? "numeric" : "" },
      el("button", { type: "button", "data-leader": key, title: hint || undefined, click: sort }, title, arrow),
      heading?.element,
    );
    return { key, arrow, heading, cell };
  });
  head.replaceChildren(
    el("th", { scope: "col" }, el("span", { class: "unseen" }, "Compare")),
    ...cells.map(({ cell }) => cell),
  );
  if (focused) head.querySelector<HTMLElement>(`[data-leader="${CSS.escape(focused)}"]`)?.focus();
  const show = (): void => {
    const { column, descending } = model.choices.sort;
    for (const { key, arrow, heading, cell } of cells) {
      cell.setAttribute("aria-sort", column !== key ? "none" : descending ? "descending" : "ascending");
      arrow.textContent = column !== key ? "" : descending ? "\u25be" : "\u25b4";
      heading?.show();
    }
  };
  show();
  return { of, show };
}

function rowOf(model: Model, columns: Column[], design: number, index: number): HTMLElement {
  const { store, choices } = model;
  const chosen = store.state.selected >= 0 && model.grouping.of[store.state.selected] === design;
  const pick = el("input", {
    id: `pick-${design}`,
    type: "checkbox",
    "aria-label": `Compare ${nameOf(model, design)}`,
    checked: choices.picked.includes(design),
    click: (event: Event) => event.stopPropagation(),
    change: () => togglePick(model, design),
  });
  const cells = columns.map(({ key, numeric, text, mark }) => {
    const kind = mark ? CLASSES[mark(design)]! : "";
    const whole = key === "design" ? text(design) : undefined;
    return el(
      "td",
      { title: whole, class: `${numeric ? "numeric" : key === "verdict" ? "verdict" : ""} ${kind}` },
      text(design),
    );
  });
  return el(
    "tr",
    {
      class: chosen ? "chosen" : "",
      "aria-selected": String(chosen),
      "aria-rowindex": index + 2,
      "data-design": design,
      click: () => selectRun(store, model.standing().deciding[design]!),
    },
    el("td", {}, pick),
    ...cells,
  );
}

function noteOf(model: Model, shown: number): string {
  const { grouping, store, choices } = model;
  const several = grouping.size < store.study.size;
  const parts = [
    `Order of designs: ${orderSentence(aimsOf(store.study), model.order())}`,
    choices.demand ? `Verdicts are with ${Math.round(100 * choices.demand)}\u202f% margin.` : "",
    model.scores().some((score) => !Number.isNaN(score))
      ? "Score: TOPSIS over the feasible designs shown (Hwang and Yoon 1981), criteria in vector normalisation, weights by their share."
      : "",
    several
      ? "Values are means over what is uncertain at the worst condition, so that a single run may be worse; a design has to meet every requirement in all its runs, and be shown to in one at least."
      : "",
    shown < grouping.size ? `${grouping.size - shown} designs are outside the brushes.` : "",
    "A row selects the run that decides; tick up to five to compare.",
  ];
  return parts.filter(Boolean).join(" ");
}

function gap(count: number, columns: number): HTMLElement {
  const row = el("tr", { class: "gap", "aria-hidden": "true" }, el("td", { colspan: columns }));
  row.style.height = `${count * ROW}px`;
  if (!count) row.hidden = true;
  return row;
}
