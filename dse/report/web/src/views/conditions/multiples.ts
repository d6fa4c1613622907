// The same cells for each requirement by itself, small: which one decides where.
import { el } from "../../dom";
import { number, percent, withUnit } from "../../format";
import type { Store } from "../../store";
import { CLASSES, SIGNS, WORDS } from "../../verdicts";
import { openRun } from "../shared/runs";
import { type Cell, cellsOf, markOf } from "./cells";
import type { Levels } from "./levels";

export function createSmall(
  store: Store,
  x: Levels,
  y: Levels,
  requirement: number,
  among: (run: number) => boolean,
  share: (cell: Cell) => [number, number] | null,
): HTMLElement {
  const { study } = store;
  const { title, metric } = study.requirements[requirement]!;
  const { unit } = study.metrics[metric]!;
  const cells = cellsOf(store, x, y, requirement, among);
  const show = (cell: Cell, row: number, column: number): HTMLElement => {
    if (!cell.runs.length) return el("td", { class: "empty" }, "\u2013");
    const mark = markOf(cell);
    const part = share(cell);
    const margin = Number.isNaN(cell.margin)
      ? ""
      : withUnit(`${cell.margin > 0 ? "+" : ""}${number(cell.margin, 2)}`, unit);
    const text = part ? percent(part[0], part[1]) : `${SIGNS[mark]} ${margin}`;
    const where = `${x.labels[column]}, ${y.labels[row]}`;
    const told = part ? `${part[0]} of ${part[1]} designs pass` : `${WORDS[mark]} ${margin}`;
    return el(
      "td",
      { class: part ? "" : CLASSES[mark]! },
      el(
        "button",
        {
          type: "button",
          "aria-label": `${title} at ${where}: ${told}; opens run ${study.number[cell.worst]}`,
          title: told,
          click: () => openRun(store, cell.worst),
        },
        text,
      ),
    );
  };
  return el(
    "div",
    {},
    el("h4", {}, title),
    el(
      "table",
      { class: "matrix small" },
      el("thead", {}, el("tr", {}, el("td", {}), ...x.labels.map((label) => el("th", { scope: "col" }, label)))),
      el(
        "tbody",
        {},
        ...cells.map((row, index) =>
          el(
            "tr",
            {},
            el("th", { scope: "row" }, y.labels[index]!),
            ...row.map((cell, column) => show(cell, index, column)),
          ),
        ),
      ),
    ),
  );
}
