// A point of the study simulated now, by the server: any point of the plot, whether there is a run or not.
import { el, field } from "../dom";
import { number, withUnit } from "../format";
import { createTrace, type Lines, type TraceFigure } from "../simulate/traces";
import type { Store } from "../store";
import { axisLabel } from "../study";
import { post } from "./requests";

type Waveform = TraceFigure & Lines;

interface Tried {
  /** Not if something has changed that the user has not accepted. */
  simulated: boolean;
  done: boolean;
  problem: string;
  changed: string[];
  /** Title, value, requirement, bound, margin and verdict of each. */
  metrics: [string, string, string, string, string, string][];
  figures: Waveform[];
}

/** What the plot tells when it is clicked where no run is: values on its two axes. */
export type PointedAt = CustomEvent<{ x: number; y: number }>;

const CLASSES: Record<string, string> = {
  pass: "pass",
  fail: "fail",
  "not exercised": "open",
  "failed to run": "broken",
};

export function createTrying(store: Store, query: string): { button: HTMLElement; panel: HTMLElement } {
  const { study } = store;
  const form = el("form", { class: "point", submit: (event: Event) => void simulate(event) });
  const result = el("div", { class: "tried", "aria-live": "polite" });
  const start = el("button", { type: "submit", id: "try-start" }, "Simulate");
  const title = el("h2", { id: "heading-try" }, "Simulate here");
  const close = el("button", { type: "button", "aria-label": "Close", click: () => toggle(false) }, "\u00d7");
  const note = el(
    "p",
    { class: "hint" },
    "Click anywhere in the plot, or change the numbers. The run uses the current workspace; nothing is stored.",
  );
  const panel = el(
    "aside",
    { class: "card trying", id: "try", hidden: true, "aria-labelledby": "heading-try" },
    el("div", { class: "head" }, title, el("span", { class: "spring" }), close),
    note,
    form,
    result,
  );
  const button = el(
    "button",
    {
      type: "button",
      id: "try-open",
      "aria-expanded": "false",
      "aria-controls": "try",
      click: () => toggle(panel.hidden),
    },
    "Simulate here",
  );
  const inputs = study.variables.map(({ name, low, high, labels }) => {
    if (labels.length)
      return el("select", { name }, ...labels.map((label, value) => label && el("option", { value }, label)));
    const input = el("input", { type: "number", step: "any", required: true, name });
    input.title = `${name}, ${number(low)} \u2026 ${number(high)} in the study`;
    return input;
  });
  const configuration = el(
    "select",
    { id: "try-configuration" },
    ...study.configurations.map(({ id }) => el("option", { value: id }, id)),
  );
  if (study.configurations.length > 1) form.append(field("Configuration", configuration));
  const fields = study.variables.map((variable, index) => field(axisLabel(variable), inputs[index]!));
  form.append(...fields, start);

  const toggle = (open: boolean): void => {
    panel.hidden = !open;
    button.setAttribute("aria-expanded", String(open));
    document.body.classList.toggle("is-trying", open);
    if (open) (inputs[0] ?? start).focus();
    else button.focus();
  };

  const fill = (): void => {
    const { selected, fixed } = store.state;
    study.variables.forEach(({ values }, index) =>
      put(inputs[index]!, selected < 0 ? fixed[index]! : values[selected]!),
    );
    configuration.value =
      study.configurations[selected < 0 ? store.state.configuration : study.configuration[selected]!]?.id ?? "";
    lacking();
  };

  // A configuration without a variable has no field for it.
  const lacking = (): void => {
    const place = study.configurations.findIndex(({ id }) => id === configuration.value);
    study.variables.forEach(({ lack }, index) => {
      const isThere = !lack.includes(place);
      fields[index]!.hidden = inputs[index]!.disabled = !isThere;
    });
  };
  configuration.addEventListener("change", lacking);

  // What was simulated last, drawn again where colours change.
  let show = (): void => {};
  // What has changed in the workspace, as the user knows.
  let accepts: string[] = [];
  const simulate = async (event?: Event): Promise<void> => {
    event?.preventDefault();
    const point: Record<string, number> = {};
    study.variables.forEach(({ name }, index) => {
      if (!inputs[index]!.disabled) point[name] = Number(inputs[index]!.value);
    });
    start.disabled = true;
    result.replaceChildren(el("p", { class: "muted" }, "simulating \u2026"));
    show = () => {};
    const begun = performance.now();
    try {
      const tried = (await post(`/simulate?${query}`, { configuration: configuration.value, point, accepts })) as Tried;
      const seconds = (performance.now() - begun) / 1000;
      const anyway = (): void => {
        accepts = tried.changed;
        void simulate();
      };
      show = () => {
        if (!tried.simulated) return result.replaceChildren(...asking(tried.changed, anyway));
        const plots: (() => void)[] = [];
        result.replaceChildren(...shown(tried, seconds, plots));
        for (const draw of plots) draw();
      };
      show();
    } catch (error) {
      result.replaceChildren(el("p", { class: "problem" }, String((error as Error).message)));
    }
    start.disabled = false;
  };

  fill();
  store.subscribe((_, changed) => {
    if (changed.has("selected")) fill();
    if (changed.has("theme")) show();
  });
  document.addEventListener("pointed-at", (event) => {
    const { x, y } = (event as PointedAt).detail;
    // After the run beside it was selected, which the click did, too.
    requestAnimationFrame(() =>
      requestAnimationFrame(() => {
        const place: [number, number][] = [
          [store.state.x, x],
          [store.state.y, y],
        ];
        for (const [index, value] of place) {
          const variable = study.variables[index]!;
          if (!variable.labels.length) put(inputs[index]!, rounded(value, variable));
        }
      }),
    );
  });
  return { button, panel };
}

function put(input: HTMLInputElement | HTMLSelectElement, value: number): void {
  input.value = String(value);
}

/** To a thousandth of the range: what a pointer can tell. */
function rounded(value: number, { low, high }: { low: number; high: number }): number {
  const decimals = Math.max(0, 3 - Math.floor(Math.log10(high - low)));
  return Number(Math.min(Math.max(value, low), high).toFixed(Math.min(20, decimals)));
}

/** Nothing has run yet: what is there now is not what the study was made with. */
function asking(changed: string[], anyway: () => void): HTMLElement[] {
  const what = `Not simulated: the workspace has changed since the study was made (${changed.join(", ")}).`;
  return [
    el("p", { class: "problem", role: "alert" }, what),
    el("button", { type: "button", id: "try-anyway", click: anyway }, "Simulate anyway"),
  ];
}

function shown(tried: Tried, seconds: number, plots: (() => void)[]): HTMLElement[] {
  const parts: HTMLElement[] = [];
  if (tried.changed.length) {
    const what = `The workspace has changed since the study was made (${tried.changed.join(", ")}): this is not a run of the study.`;
    parts.push(el("p", { class: "problem" }, what));
  }
  if (!tried.done) return [...parts, el("p", { class: "problem" }, `The run failed: ${tried.problem}`)];
  if (tried.problem) parts.push(el("p", { class: "hint" }, tried.problem));
  const judged = tried.metrics.filter(([, , requirement]) => requirement);
  const rest = tried.metrics.filter(([, , requirement]) => !requirement);
  if (judged.length) parts.push(listed(judged, "try-metrics"));
  for (const figure of tried.figures) {
    const chart = createTrace(figure, "of the point simulated");
    parts.push(chart.element);
    plots.push(() => chart.show(figure));
  }
  const others = listed(rest, "try-others");
  if (rest.length)
    parts.push(
      judged.length
        ? el("details", { class: "others" }, el("summary", {}, `${rest.length} metrics without a requirement`), others)
        : others,
    );
  return [...parts, el("p", { class: "hint" }, `simulated in ${withUnit(number(seconds, 2), "s")}; not stored`)];
}

function listed(metrics: Tried["metrics"], id: string): HTMLElement {
  const isJudged = metrics.some(([, , requirement]) => requirement);
  const heads = ["Metric", "Value", ...(isJudged ? ["Required", "Margin", "Verdict"] : [])];
  const body = el("tbody");
  for (const [title, value, requirement, bound, margin, verdict] of metrics) {
    const judged = [
      el("td", {}, bound),
      el("td", {}, margin),
      el("td", { class: `verdict ${CLASSES[verdict] ?? ""}` }, verdict),
    ];
    body.append(
      el(
        "tr",
        { class: requirement && "judged", title: requirement },
        el("th", { scope: "row" }, title),
        el("td", {}, value),
        ...(isJudged ? judged : []),
      ),
    );
  }
  const head = el("thead", {}, el("tr", {}, ...heads.map((text) => el("th", { scope: "col" }, text))));
  return el("div", { class: "scroll" }, el("table", { class: "metrics", id }, head, body));
}
