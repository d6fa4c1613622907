// The selected run: its parameters, its metrics against the thresholds, and its parameters as YAML.
import { el } from "../dom";
import { checked, count, number, percent, withUnit } from "../format";
import type { Store } from "../store";
import type { Study } from "../study";
import { CLASSES, drawsAt, errorOf, isDoubtful, margin, SIGNS, type Threshold, WORDS, wordFor } from "../verdicts";
import { variablesOf, yamlOf } from "../yaml";
import { copyParts } from "./copy";
import { replaying } from "./replay";

const ROOMY = "(min-width: 1800px)";

/** What there is to know of the selected run, and its name with its verdict. */
export function createSelected(store: Store): { box: HTMLElement; name: HTMLElement } {
  const box = el("div", { class: "selected" });
  const name = el("span", { class: "run-name" });
  let open = false;
  // Elsewhere the list would push the waveforms off the screen; the requirements' rows tell what decides.
  let numbers = matchMedia(ROOMY).matches;
  const draw = (): void => {
    const { study } = store;
    const run = store.state.selected;
    name.replaceChildren(
      ...(run < 0
        ? []
        : [el("b", { id: "selected-run" }, `Run ${study.number[run]}`), badge(store.judgement().overall[run]!)]),
    );
    if (run < 0) return box.replaceChildren(el("p", { class: "muted" }, "No run is selected."));
    const problem = study.problems.get(run);
    const {
      judgement: { overall },
      deciding,
      noun,
    } = store.designs();
    const other = deciding(run);
    const elsewhere =
      noun === "design" && overall[run] !== store.judgement().overall[run]
        ? el(
            "p",
            { class: "hint", id: "design-verdict" },
            `Its design at the worst of its conditions: ${wordFor(overall[run]!, noun)}, decided by run ${study.number[other]}.`,
          )
        : "";
    const metrics = el(
      "details",
      { class: "numbers", open: numbers, toggle: () => (numbers = metrics.open) },
      el("summary", {}, count(study.metrics.length, "metric")),
      metricsTable(store, run),
    );
    const yaml = yamlParts(study, run, open, (now) => (open = now));
    box.replaceChildren(
      ...(problem === undefined ? [] : [el("p", { class: "problem" }, problem)]),
      elsewhere,
      parameters(study, run),
      el("div", { class: "folds" }, metrics, ...yaml),
      ...replaying(study, run),
    );
  };
  draw();
  store.subscribe((_, changed) => {
    if (changed.has("selected") || changed.has("thresholds")) draw();
  });
  return { box, name };
}

export function badge(mark: number): HTMLElement {
  return el("span", { class: `badge ${CLASSES[mark]}` }, `${SIGNS[mark]} ${WORDS[mark]}`);
}

function parameters(study: Study, run: number): HTMLElement {
  const list = el("dl", { class: "parameters" });
  for (const { title, name, unit, values, text } of variablesOf(study, run)) {
    list.append(el("div", { title: name }, el("dt", {}, title), el("dd", {}, withUnit(text(values[run]!), unit))));
  }
  const configuration = study.configurations[study.configuration[run]!]!;
  const choices = configuration.choices.map(([place, component]) => `${place}: ${component}`).join("\n");
  if (study.configurations.length > 1 || !study.variables.length) {
    list.prepend(
      el("div", { title: choices }, el("dt", {}, "Configuration"), el("dd", {}, el("code", {}, configuration.id))),
    );
  }
  return list;
}

const DOUBT =
  "Finer numerics may change it: the margin is within two error bars, or a repetition gave another verdict or none.";
const MORE_DRAWS = "More draws may change it: these do not tell whether enough of them meet the requirement.";

function metricsTable(store: Store, run: number): HTMLElement {
  const { study, state } = store;
  const { each } = store.judgement();
  const head = ["Metric", "Value", "Required", "Margin", "Verdict"];
  const body = el("tbody");
  study.metrics.forEach((metric, index) => {
    const value = metric.values[run]!;
    const bound = study.requirements.flatMap((requirement, place) => (requirement.metric === index ? [place] : []));
    const error = errorOf(study, index, run);
    const shown = study.done[run] ? withUnit(checked(value, error, metric.text), metric.unit) : "\u2013";
    const name = el("th", { scope: "row", title: metric.name }, metric.title);
    if (!bound.length) {
      body.append(el("tr", {}, name, el("td", {}, shown), el("td"), el("td"), el("td")));
      return;
    }
    bound.forEach((place, order) => {
      const threshold = state.thresholds[place]!;
      const mark = each[place]![run]!;
      const by = margin(value, threshold);
      const isOpen = isDoubtful(study, place, run, threshold);
      const draws = drawsAt(study, place, run, threshold);
      body.append(
        el(
          "tr",
          { class: "judged", title: study.requirements[place]!.title },
          order ? el("th", { scope: "row", class: "again" }, metric.title) : name,
          el("td", {}, shown),
          el("td", {}, bounds(threshold, metric.unit)),
          el(
            "td",
            { class: mark < 2 ? CLASSES[mark]! : "muted" },
            study.done[run] && !Number.isNaN(by) ? signed(by, metric.unit) : "\u2013",
          ),
          el(
            "td",
            { class: `verdict ${CLASSES[mark]}`, title: isOpen ? (draws ? MORE_DRAWS : DOUBT) : "" },
            `${SIGNS[mark]} ${WORDS[mark]}${isOpen ? ", doubtful" : ""}`,
            draws ? el("small", { class: "draws" }, drawsText(draws)) : "",
          ),
        ),
      );
    });
  });
  return el(
    "div",
    { class: "scroll" },
    el(
      "table",
      { class: "metrics", id: "metrics" },
      el("thead", {}, el("tr", {}, ...head.map((text) => el("th", { scope: "col" }, text)))),
      body,
    ),
  );
}

function drawsText({ met, judged, low, high }: { met: number; judged: number; low: number; high: number }): string {
  const rate = low === high ? "" : ` (${percent(low, 1)} \u2026 ${percent(high, 1)})`;
  return `in ${met} of ${judged} draws${rate}`;
}

export function bounds({ atMost, atLeast }: Threshold, unit: string): string {
  const parts = [];
  if (atLeast !== null) parts.push(`\u2265\u202f${number(atLeast)}`);
  if (atMost !== null) parts.push(`\u2264\u202f${number(atMost)}`);
  return withUnit(parts.join(" and "), unit);
}

function signed(value: number, unit: string): string {
  return withUnit(`${value > 0 ? "+" : ""}${number(value, 3)}`, unit);
}

function yamlParts(study: Study, run: number, open: boolean, toggled: (open: boolean) => void): HTMLElement[] {
  return copyParts("yaml", "Parameters as YAML", "Copy as YAML", () => yamlOf(study, run), open, toggled);
}
