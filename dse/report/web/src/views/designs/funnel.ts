// What the static constraints leave of the design space before anything is simulated, and what no design can have.
import { el } from "../../dom";
import { percent } from "../../format";
import type { Funnel } from "../../notes";
import type { Study } from "../../study";

export function createFunnel(study: Study, funnel: Funnel): HTMLElement {
  const heads = ["Constraint", "Left after it and those before", "", "Because"].map((text, place) =>
    el("th", { scope: "col", class: place === 1 ? "numeric" : "" }, text || el("span", { class: "unseen" }, "Bar")),
  );
  const few = funnel.steps.some(({ count }) => count < 0.01 * funnel.count);
  // Of very many the few that are left would not be seen.
  const length = (count: number): number =>
    few ? Math.log(count + 1) / Math.log(funnel.count + 1) : count / Math.max(funnel.count, 1);
  const row = rowWith(length, funnel.count);
  const rows = funnel.steps.map((step, index) => {
    const idle = step.count === (index ? funnel.steps[index - 1]! : funnel).count;
    return row(
      el("span", { title: step.rule }, step.constraint),
      step.text,
      step.count,
      `${step.because || step.rule}${idle ? " (excludes nothing more)" : ""}`,
    );
  });
  const table = el(
    "table",
    { class: "boxes", id: "funnel" },
    el("thead", {}, el("tr", {}, ...heads)),
    el(
      "tbody",
      {},
      row("all combinations", funnel.text, funnel.count, ""),
      ...rows,
      row("designs of this study", String(study.configurations.length), study.configurations.length, ""),
    ),
  );
  return el(
    "div",
    { class: "waterfall" },
    el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "What static constraints leave" }, table),
    el(
      "p",
      { class: "hint" },
      few ? "Bars are logarithmic. " : "",
      el("code", {}, `dse space constraints ${funnel.design}`),
      " lists what each constraint excludes by itself, and what removing it would gain; ",
      el("code", {}, `dse space explain ${funnel.design} --choose PLACE=ALTERNATIVE`),
      " why a configuration is not there.",
    ),
    ...absentOf(funnel),
  );
}

type Row = (title: HTMLElement | string, text: string, count: number, why: string) => HTMLElement;

function rowWith(length: (count: number) => number, all: number): Row {
  return (title, text, count, why) => {
    const bar = el("span", { class: "bar" });
    bar.style.width = `${100 * length(count)}%`;
    return el(
      "tr",
      {},
      el("th", { scope: "row" }, title),
      el("td", { class: "numeric" }, `${text} (${percent(count, all)})`),
      el("td", { class: "drawn" }, bar),
      el("td", { class: "because" }, why),
    );
  };
}

function absentOf({ absent, steps }: Funnel): HTMLElement[] {
  if (!absent.length) return [el("p", { class: "hint" }, "Every alternative appears in some valid configuration.")];
  const because = new Map(steps.map((step) => [step.constraint, step.because]));
  const items = absent.map(({ place, choice, constraints }) => {
    const why = constraints.map((name) => (because.get(name) ? `${name} (${because.get(name)})` : name)).join(" and ");
    return el(
      "li",
      {},
      el("b", {}, `${place} = ${choice}`),
      why
        ? ` appears in no valid configuration because of ${why}.`
        : " appears in no valid configuration: other choices exclude it, independent of the constraints.",
    );
  });
  return [el("h4", {}, "Alternatives in no valid design"), el("ul", { class: "changes", id: "absent" }, ...items)];
}
