// The question: bench, sampler and objectives as sentences, the variables as a table.
import { el } from "../../dom";
import { number, withUnit } from "../../format";
import type { Asked } from "../../insight";
import type { Study } from "../../study";

export function createAsked(study: Study, asked: Asked): HTMLElement {
  const head = (text: string, numeric = false): HTMLElement =>
    el("th", { scope: "col", class: numeric ? "numeric" : "" }, text);
  const rows = study.variables.map((variable, index) =>
    el(
      "tr",
      {},
      el("th", { scope: "row", title: variable.name }, variable.title),
      el("td", { class: "role" }, asked.roles[index] ?? ""),
      el(
        "td",
        { class: "numeric" },
        variable.labels.length
          ? ""
          : withUnit(`${number(variable.low)} \u2026 ${number(variable.high)}`, variable.unit),
      ),
      el("td", {}, asked.spreads[index] ?? ""),
      el(
        "td",
        { class: "numeric" },
        variable.labels.length ? variable.text(variable.nominal) : withUnit(number(variable.nominal), variable.unit),
      ),
    ),
  );
  const table = el(
    "div",
    { class: "scroll", tabindex: 0, role: "region", "aria-label": "Variables" },
    el(
      "table",
      { class: "plain", id: "variables" },
      el(
        "thead",
        {},
        el("tr", {}, head("Variable"), head("Role"), head("Range", true), head("Values"), head("Nominal", true)),
      ),
      el("tbody", {}, ...rows),
    ),
  );
  return el(
    "div",
    {},
    ...asked.sentences.map((sentence) => el("p", { class: "sentence" }, sentence)),
    rows.length > 0 && table,
  );
}
