// A light for each requirement, with how many runs pass and the margins of the best and the worst of them.
import { el } from "../../dom";
import { group, number, withUnit } from "../../format";
import type { Store } from "../../store";
import { rowNoun } from "../../study";
import { FAIL, FAILED, margin, NOT_EXERCISED, PASS, type Threshold, tally } from "../../verdicts";
import { runButton } from "../shared/runs";

type Light = "pass" | "some" | "fail" | "open";

const LIGHTS: Record<Light, [string, string]> = {
  pass: ["\u2713", "met by all"],
  some: ["\u25d0", "met by some"],
  fail: ["\u2717", "met by none"],
  open: ["\u25cb", "not exercised"],
};

export function createRequirements(store: Store): HTMLElement {
  const body = el("tbody", {});
  const draw = (): void => body.replaceChildren(...rows(store));
  draw();
  store.subscribe((_, changed) => {
    if (changed.has("thresholds")) draw();
  });
  const head = (text: string, numeric = false): HTMLElement =>
    el("th", { scope: "col", class: numeric ? "numeric" : "" }, text);
  const columns = el(
    "thead",
    {},
    el(
      "tr",
      {},
      head("Requirement"),
      head("Bound"),
      head(store.designs().noun === "run" ? "Runs that pass" : "Designs that pass", true),
      head("Best margin", true),
      head("Worst margin", true),
    ),
  );
  return el(
    "div",
    {},
    el(
      "div",
      { class: "scroll", tabindex: 0, role: "region", "aria-label": "Table of requirements" },
      el("table", { class: "plain lights-table", id: "lights" }, columns, body),
    ),
    el(
      "p",
      { class: "hint" },
      store.designs().noun === "run"
        ? "Of all runs of the study, at the thresholds that are set; runs that do not exercise a requirement count neither way."
        : `Of all designs of the study at the worst of their conditions, at the thresholds that are set; margins are those of single ${rowNoun(store.study)}s.`,
    ),
  );
}

function rows(store: Store): HTMLElement[] {
  const { study, state } = store;
  const {
    judgement: { each, overall },
    runs,
  } = store.designs();
  const all = tally(study, overall, -1, runs);
  const off = state.thresholds.filter(({ off }) => off).length;
  return [
    el(
      "tr",
      { class: "overall" },
      el(
        "th",
        { scope: "row" },
        light(all),
        "All requirements",
        off ? el("span", { class: "muted" }, ` without ${off} switched off`) : null,
      ),
      el("td", {}, ""),
      el("td", { class: "numeric" }, share(all)),
      el("td", {}),
      el("td", {}),
    ),
    ...study.requirements.map((requirement, index) => {
      const threshold = state.thresholds[index]!;
      const counts = tally(study, each[index]!, -1, runs);
      const { unit, values, title } = study.metrics[requirement.metric]!;
      const [best, worst] = extremes(values, store.judgement().each[index]!, threshold);
      const told = (run: number): HTMLElement =>
        el(
          "td",
          { class: "numeric" },
          run < 0 ? "\u2013" : runButton(store, run, signed(margin(values[run]!, threshold), unit)),
        );
      return el(
        "tr",
        { class: threshold.off ? "off" : "" },
        el(
          "th",
          { scope: "row", title: requirement.name },
          light(counts),
          requirement.title,
          threshold.off ? el("span", { class: "muted" }, " switched off") : null,
        ),
        el("td", {}, `${title} ${bound(threshold, unit)}`),
        el("td", { class: "numeric" }, share(counts)),
        told(best),
        told(worst),
      );
    }),
  ];
}

function light(counts: number[]): HTMLElement {
  const kind: Light = counts[PASS]
    ? counts[FAIL] || counts[FAILED]
      ? "some"
      : "pass"
    : counts[FAIL] || counts[FAILED]
      ? "fail"
      : "open";
  const [sign, words] = LIGHTS[kind];
  return el(
    "span",
    { class: `light ${kind}`, title: words },
    el("span", { "aria-hidden": "true" }, sign),
    el("span", { class: "unseen" }, `${words}: `),
  );
}

function share(counts: number[]): HTMLElement {
  const judged = counts[PASS]! + counts[FAIL]!;
  const rest = [
    counts[NOT_EXERCISED] ? `${group(counts[NOT_EXERCISED])} not exercised` : "",
    counts[FAILED] ? `${group(counts[FAILED])} failed to run` : "",
  ]
    .filter(Boolean)
    .join(", ");
  const bar = el("span", { class: "meter", "aria-hidden": "true" }, el("span", {}));
  (bar.firstChild as HTMLElement).style.width = `${judged ? (100 * counts[PASS]!) / judged : 0}%`;
  return el(
    "span",
    {},
    el("b", {}, group(counts[PASS]!)),
    ` of ${group(judged)}`,
    bar,
    rest && el("span", { class: "muted rest" }, rest),
  );
}

function bound({ atLeast, atMost }: Threshold, unit: string): string {
  const parts = [
    atLeast === null ? "" : `\u2265 ${withUnit(number(atLeast), unit)}`,
    atMost === null ? "" : `\u2264 ${withUnit(number(atMost), unit)}`,
  ];
  return parts.filter(Boolean).join(" and ");
}

function signed(value: number, unit: string): string {
  return withUnit(`${value > 0 ? "+" : ""}${number(value, 3)}`, unit);
}

function extremes(values: Float64Array, marks: Uint8Array, threshold: Threshold): [number, number] {
  let [best, worst] = [-1, -1];
  for (let run = 0; run < marks.length; run++) {
    if (marks[run] !== PASS && marks[run] !== FAIL) continue;
    const here = margin(values[run]!, threshold);
    if (!Number.isFinite(here)) continue;
    if (best < 0 || here > margin(values[best]!, threshold)) best = run;
    if (worst < 0 || here < margin(values[worst]!, threshold)) worst = run;
  }
  return [best, worst];
}
