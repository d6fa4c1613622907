// The verdicts and metrics of the run that is simulated, beside those of the one it started from.
import { el } from "../dom";
import { number, withUnit } from "../format";
import type { Store } from "../store";
import { CLASSES, FAIL, margin, NOT_APPLICABLE, NOT_EXERCISED, PASS, WORDS } from "../verdicts";
import type { Ran } from "./engine";

/** Requirements with their verdicts at the reader's thresholds, and the other metrics. */
export function createVerdicts(store: Store): { element: HTMLElement; show: (ran: Ran, before: Ran | null) => void } {
  const others = el("div", {});
  const rest = el("details", {}, el("summary", {}, "Other metrics"), others);
  const judged = el("div", {});
  const element = el("div", { class: "tried", id: "simulated" }, judged, rest);
  return {
    element,
    show(ran, before) {
      element.hidden = Boolean(ran.problem);
      if (ran.problem) return;
      const [first, second] = rowsOf(store, ran, before);
      judged.replaceChildren(table(["Requirement", "Value", "At the start", "Required", "Verdict"], first));
      others.replaceChildren(table(["Metric", "Value", "At the start"], second));
      judged.hidden = !first.length;
      rest.hidden = !second.length;
    },
  };
}

/** Rows of requirements and of other metrics; *before* is where it started. */
function rowsOf({ study, state }: Store, ran: Ran, before: Ran | null): [HTMLElement[], HTMLElement[]] {
  const text = (value: number, unit: string): string => withUnit(number(value, 6), unit);
  const judged = study.requirements.flatMap(({ title, metric, name }, index) => {
    const { atMost, atLeast } = state.thresholds[index]!;
    if (ran.marks[index] === NOT_APPLICABLE) return [];
    const { unit } = study.metrics[metric]!;
    const value = ran.metrics[metric]!;
    const by = margin(value, { atMost, atLeast });
    const mark = ran.marks[index] === NOT_EXERCISED ? NOT_EXERCISED : by >= 0 ? PASS : FAIL;
    const bound = [
      atLeast === null ? "" : `\u2265 ${text(atLeast, unit)}`,
      atMost === null ? "" : `\u2264 ${text(atMost, unit)}`,
    ];
    const word = ran.close[index] ? `${WORDS[mark]}, at the bound` : WORDS[mark];
    return [
      el(
        "tr",
        { class: "judged" },
        el("th", { scope: "row", title: name }, title),
        el("td", {}, text(value, unit)),
        el("td", { class: "muted" }, before ? text(before.metrics[metric]!, unit) : ""),
        el("td", {}, bound.filter(Boolean).join(", ")),
        el("td", { class: `verdict ${CLASSES[mark]}` }, word!),
      ),
    ];
  });
  const asked = new Set(study.requirements.map(({ metric }) => metric));
  const others = study.metrics.flatMap(({ title, unit }, at) =>
    asked.has(at)
      ? []
      : [
          el(
            "tr",
            {},
            el("th", { scope: "row" }, title),
            el("td", {}, text(ran.metrics[at]!, unit)),
            el("td", { class: "muted" }, before ? text(before.metrics[at]!, unit) : ""),
          ),
        ],
  );
  return [judged, others];
}

function table(heads: string[], rows: HTMLElement[]): HTMLElement {
  const head = el("tr", {}, ...heads.map((text) => el("th", { scope: "col" }, text)));
  return el(
    "div",
    { class: "scroll" },
    el("table", { class: "metrics" }, el("thead", {}, head), el("tbody", {}, ...rows)),
  );
}
