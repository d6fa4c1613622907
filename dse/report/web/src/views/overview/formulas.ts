// What each number is: formulas of the metrics, bounds of the requirements and when these count.
import { el } from "../../dom";
import { number, withUnit } from "../../format";
import type { Asked } from "../../insight";
import type { Study } from "../../study";

export function createFormulas(study: Study, asked: Asked): HTMLElement {
  const list = el("dl", { class: "formulas" });
  study.metrics.forEach((metric, index) => {
    const judged = study.requirements.flatMap((requirement, place) => (requirement.metric === index ? [place] : []));
    list.append(
      el("dt", {}, metric.title, metric.unit && el("span", { class: "muted" }, ` [${metric.unit}]`)),
      el(
        "dd",
        {},
        el("code", {}, asked.expressions[index] ?? ""),
        ...judged.map((place) => {
          const { title, atLeast, atMost } = study.requirements[place]!;
          const when = asked.exercised[place];
          const bounds = [
            atLeast === null ? "" : `at least ${withUnit(number(atLeast), metric.unit)}`,
            atMost === null ? "" : `at most ${withUnit(number(atMost), metric.unit)}`,
          ];
          return el(
            "div",
            { class: "bound" },
            `${title}: ${bounds.filter(Boolean).join(", ")}`,
            when ? el("span", {}, "; counts only when ", el("code", {}, when)) : "; counts in every run",
          );
        }),
      ),
    );
  });
  return list;
}
