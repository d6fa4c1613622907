// The verdict matrix as a table: a sign, counts and the worst margin in each cell; a click opens the worst run.
import { el } from "../../dom";
import { count, group, number, percent, withUnit } from "../../format";
import type { Store } from "../../store";
import { rowNoun, type Study } from "../../study";
import { CLASSES, FAIL, FAILED, NOT_APPLICABLE, NOT_EXERCISED, PASS, SIGNS, WORDS } from "../../verdicts";
import { SHARE_OF, shareText } from "../shared/margins";
import { openRun } from "../shared/runs";
import { type Cell, cellsOf, markOf } from "./cells";
import { designsOf } from "./designs";
import { levelsOf, oneLevel } from "./levels";
import { createSmall } from "./multiples";
import type { Chosen } from "./selection";

const keys = new WeakMap<Study, string[]>();

export function createMatrix(store: Store, chosen: Chosen): HTMLElement {
  const { study, state } = store;
  const [across, down] = [study.variables[chosen.x]!, chosen.y < 0 ? null : study.variables[chosen.y]!];
  const x = levelsOf(across);
  const y = down ? levelsOf(down) : oneLevel(study.size);
  const designs = keys.get(study) ?? designsOf(study);
  keys.set(study, designs);
  const mine = state.selected < 0 ? null : designs[state.selected]!;
  const among = (run: number): boolean => chosen.whole || designs[run] === mine;
  const cells = cellsOf(store, x, y, chosen.requirement, among);
  const shown = cells.flat().filter(({ runs }) => runs.length);
  const head = (text: string): HTMLElement => el("th", { scope: "col" }, text);
  const table = el(
    "table",
    { class: "matrix", id: "matrix" },
    el("caption", { class: "unseen" }, `Verdicts over ${across.title}${down ? ` and ${down.title}` : ""}`),
    el(
      "thead",
      {},
      down &&
        el(
          "tr",
          {},
          el("td", {}),
          el("th", { scope: "colgroup", colspan: x.labels.length, class: "axis" }, `${across.title} \u2192`),
        ),
      el(
        "tr",
        {},
        el("th", { scope: "col", class: "axis" }, down ? `${down.title} \u2193` : across.title),
        ...x.labels.map(head),
      ),
    ),
    el(
      "tbody",
      {},
      ...cells.map((row, index) =>
        el(
          "tr",
          {},
          el("th", { scope: "row" }, down ? y.labels[index]! : "verdict"),
          ...row.map((cell) => cellOf(store, cell, chosen, designs)),
        ),
      ),
    ),
  );
  const each = chosen.requirement < 0 && study.requirements.length > 1;
  const share =
    (index: number) =>
    (cell: Cell): [number, number] | null =>
      chosen.whole ? passingDesigns(store, cell, { ...chosen, requirement: index }, designs) : null;
  const small = each
    ? [
        el("h3", { class: "small-head" }, "Requirement by requirement"),
        el(
          "div",
          { class: "smalls" },
          ...study.requirements.map((_, index) => createSmall(store, x, y, index, among, share(index))),
        ),
      ]
    : [];
  return el(
    "div",
    {},
    el("p", { class: "headline-small" }, sentence(store, chosen, shown, cells.flat().length, designs)),
    el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Verdict matrix" }, table),
    legend(),
    ...small,
  );
}

function cellOf(store: Store, cell: Cell, chosen: Chosen, designs: string[]): HTMLElement {
  if (!cell.runs.length) return el("td", { class: "empty" }, el("span", { class: "muted" }, "no run"));
  const { study, state } = store;
  const mark = markOf(cell);
  const unit = chosen.requirement < 0 ? "" : study.metrics[study.requirements[chosen.requirement]!.metric]!.unit;
  const worst = Number.isNaN(cell.margin)
    ? ""
    : chosen.requirement < 0
      ? shareText(cell.margin)
      : withUnit(`${cell.margin > 0 ? "+" : ""}${number(cell.margin, 3)}`, unit);
  const passing = passingDesigns(store, cell, chosen, designs);
  const head = chosen.whole
    ? `${passing[0] ? percent(passing[0], passing[1]) : "0\u202f%"} of designs pass`
    : cell.runs.length > 1
      ? `${SIGNS[mark]} ${group(cell.counts[PASS]!)} of ${count(cell.runs.length, rowNoun(study))} pass`
      : `${SIGNS[mark]} ${WORDS[mark]}`;
  const detail = chosen.whole ? `${group(passing[0])} of ${group(passing[1])}` : "";
  const box = el(
    "button",
    {
      type: "button",
      title: `Open run ${study.number[cell.worst]}, the worst here`,
      class: cell.worst === state.selected ? "here" : "",
      click: () => openRun(store, cell.worst),
    },
    el("b", {}, head),
    el("span", {}, [detail, worst && `worst margin ${worst}`].filter(Boolean).join(", ") || otherwise(cell)),
    el("span", { class: "muted" }, `Run ${study.number[cell.worst]}`),
  );
  const td = el("td", { class: chosen.whole ? "aggregate" : CLASSES[mark]! }, box);
  // Shares are a bar as well as a number, so that no colour needs to be told from another.
  if (chosen.whole) box.style.setProperty("--share", `${passing[1] ? (100 * passing[0]) / passing[1] : 0}%`);
  return td;
}

function otherwise({ counts }: Cell): string {
  return [
    counts[NOT_EXERCISED] ? `${group(counts[NOT_EXERCISED])} not exercised` : "",
    counts[FAILED] ? `${group(counts[FAILED])} failed to run` : "",
  ]
    .filter(Boolean)
    .join(", ");
}

// A design passes in a cell if all of its runs there do.
function passingDesigns(store: Store, cell: Cell, { requirement }: Chosen, designs: string[]): [number, number] {
  const { each, overall } = store.judgement();
  const marks = requirement < 0 ? overall : each[requirement]!;
  const there = new Set<string>();
  const failing = new Set<string>();
  for (const run of cell.runs) {
    if (marks[run] === NOT_APPLICABLE) continue;
    there.add(designs[run]!);
    if (marks[run] !== PASS) failing.add(designs[run]!);
  }
  return [there.size - failing.size, there.size];
}

function sentence({ study, state }: Store, chosen: Chosen, shown: Cell[], all: number, designs: string[]): string {
  const about = chosen.requirement < 0 ? "all requirements" : study.requirements[chosen.requirement]!.title;
  if (chosen.whole)
    return `Shares of ${count(new Set(designs).size, "design")} that meet ${about} in all their runs of a cell.`;
  if (state.selected < 0) return "No run is selected.";
  const met = shown.filter((cell) => markOf(cell) === PASS).length;
  const gaps = all - shown.length;
  return `The design of run ${study.number[state.selected]} meets ${about} in ${met} of ${count(shown.length, "cell")} it was run in${gaps ? `; in ${gaps} it was not run` : ""}.`;
}

function legend(): HTMLElement {
  return el(
    "ul",
    { class: "legend" },
    ...[PASS, FAIL, NOT_EXERCISED, FAILED].map((mark) =>
      el("li", {}, el("span", { class: `badge ${CLASSES[mark]}` }, SIGNS[mark]), el("span", {}, WORDS[mark])),
    ),
    el(
      "li",
      {},
      `The margin of all requirements together is the least of theirs, as a share ${SHARE_OF}. A click opens the worst run of a cell.`,
    ),
  );
}
