// One row per configuration: what was chosen, what it costs, and how it did.
import { counterparts, selectConfiguration } from "../actions";
import { el } from "../dom";
import { group } from "../format";
import type { Store } from "../store";
import { axisLabel, type Configuration } from "../study";
import { CLASSES, PASS, SIGNS, tally, WORDS } from "../verdicts";

export function createConfigurations(store: Store): HTMLElement {
  const box = el("div", {
    class: "view configurations",
    tabindex: 0,
    "aria-label": "Configuration table; up and down arrows move the selection",
  });
  const draw = (): void => box.replaceChildren(tableOf(store));
  box.addEventListener("keydown", (event) => {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (!step) return;
    event.preventDefault();
    const last = store.study.configurations.length - 1;
    selectConfiguration(store, Math.min(last, Math.max(0, store.state.configuration + step)));
    requestAnimationFrame(() => box.querySelector(".chosen")?.scrollIntoView({ block: "nearest" }));
  });
  store.subscribe((_, changed) => {
    if (
      changed.has("configuration") ||
      changed.has("thresholds") ||
      changed.has("brushes") ||
      (changed.has("selected") && store.study.variables.length)
    )
      draw();
  });
  draw();
  if (!store.study.variables.length) return box;
  return el(
    "div",
    {},
    box,
    el(
      "p",
      { class: "hint" },
      "Metrics at the parameters of the selected run, or of the configuration\u2019s first run.",
    ),
  );
}

function tableOf(store: Store): HTMLElement {
  const { study, state } = store;
  const places = names(study.configurations, "choices").filter((name) => differs(study.configurations, name));
  const properties = names(study.configurations, "properties");
  const many = study.variables.length > 0;
  const shown = counterparts(store);
  const within = store.within();
  const { each, overall } = store.judgement();
  const designs = store.designs();
  const head = (text: string, numeric = false): HTMLElement =>
    el("th", { scope: "col", class: numeric ? "numeric" : "" }, text);
  const rows = study.configurations.map((configuration, index) => {
    const run = shown[index]!;
    const counts = many ? tally(study, designs.judgement.overall, index, designs.runs) : [];
    const total = counts.reduce((sum, value) => sum + value, 0);
    const mark = run < 0 ? -1 : overall[run]!;
    return el(
      "tr",
      {
        class: `${state.configuration === index ? "chosen" : ""} ${!many && within && run >= 0 && !within[run] ? "outside" : ""}`,
        "aria-selected": String(state.configuration === index),
        click: () => selectConfiguration(store, index),
        pointerenter: () => store.set({ hovered: run }),
        pointerleave: () => store.set({ hovered: -1 }),
      },
      el("td", {}, el("code", {}, configuration.id)),
      many
        ? el("td", { class: "numeric" }, `${group(counts[PASS]!)} of ${group(total)}`)
        : el("td", { class: `verdict ${CLASSES[mark] ?? ""}` }, mark < 0 ? "no run" : `${SIGNS[mark]} ${WORDS[mark]}`),
      ...places.map((name) => el("td", {}, lookUp(configuration.choices, name))),
      ...properties.map((name) => el("td", { class: "numeric" }, lookUp(configuration.properties, name))),
      ...study.metrics.map((metric, place) => {
        const judged = study.requirements.findIndex((requirement) => requirement.metric === place);
        const kind = run < 0 || judged < 0 ? "" : CLASSES[each[judged]![run]!]!;
        return el(
          "td",
          { class: `numeric ${kind}` },
          run < 0 || !study.done[run] ? "\u2013" : metric.text(metric.values[run]!),
        );
      }),
    );
  });
  return el(
    "table",
    { class: "runs", id: "configurations" },
    el(
      "thead",
      {},
      el(
        "tr",
        {},
        head("Configuration"),
        many ? head(`${designs.noun === "run" ? "Runs" : "Designs"} that pass`, true) : head("Verdict"),
        ...places.map((name) => head(name)),
        ...properties.map((name) => head(name, true)),
        ...study.metrics.map((metric) => head(axisLabel(metric), true)),
      ),
    ),
    el("tbody", {}, ...rows),
  );
}

function names(configurations: Configuration[], key: "choices" | "properties"): string[] {
  return [...new Set(configurations.flatMap((configuration) => configuration[key].map(([name]) => name)))];
}

// A choice that is the same everywhere tells nothing apart.
function differs(configurations: Configuration[], name: string): boolean {
  return configurations.length === 1 || new Set(configurations.map(({ choices }) => lookUp(choices, name))).size > 1;
}

function lookUp(pairs: [string, string][], name: string): string {
  return pairs.find(([key]) => key === name)?.[1] ?? "\u2013";
}
