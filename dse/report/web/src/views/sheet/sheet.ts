// The requirements for a review board: what is asked, where it comes from, what the runs came to, of which files. Printed
// by itself it is a document.
import { card, el } from "../../dom";
import { checked, count, group, number, shortened, withUnit } from "../../format";
import { groupingOf } from "../../grouping";
import type { Store } from "../../store";
import type { Requirement, Study } from "../../study";
import { CLASSES, SIGNS, type Threshold, WORDS } from "../../verdicts";
import { createModel, type Model, nameOf } from "../designs/model";
import { runButton } from "../shared/runs";
import type { View } from "../view";
import { type Result, resultOf } from "./results";

const MOST_DESIGNS = 20;
const MOST_RUNS = 8;
const MOST_NAME = 160;

export const sheetView: View = {
  name: "sheet",
  title: "Requirements",
  suits: (study) => study.size > 0 && study.requirements.length > 0,
  create(store) {
    const model = createModel(store);
    const root = el("div", { class: "sheet" });
    const draw = (): void => root.replaceChildren(...cardsOf(model));
    store.subscribe((_, changed) => {
      if (changed.has("thresholds") || changed.has("settings")) draw();
    });
    draw();
    return root;
  },
};

function cardsOf(model: Model): HTMLElement[] {
  const { store, grouping, choices } = model;
  const { study } = store;
  const designs = choices.picked.length ? [...choices.picked] : [...model.order().ranked.subarray(0, MOST_DESIGNS)];
  const left = grouping.size - designs.length;
  const which = choices.picked.length
    ? "These are the designs that are picked in the leader board."
    : left
      ? `These are the ${designs.length} first designs in the order of the leader board.`
      : "These are all designs.";
  const told =
    grouping.size > 1
      ? `${which} ${left ? `${count(left, "more design")} ${left === 1 ? "is" : "are"} not listed. ` : ""}`
      : "";
  const print = el("button", { id: "print-sheet", type: "button", click: () => window.print() }, "Print this sheet");
  const about =
    "A verdict is the worst of all points; the run is that of the least margin, and the rate the lowest of any point. ";
  const moved = study.requirements.some((requirement, index) => isMoved(requirement, store.state.thresholds[index]!));
  return [
    card(
      "sheet-head",
      `Requirements of ${study.title}`,
      el("p", {}, told, about, moved && el("b", {}, "Bounds are not those of the study.")),
      print,
      designs.length > 1 &&
        el("ol", { id: "sheet-designs" }, ...designs.map((design) => el("li", {}, nameIn(model, design)))),
    ),
    ...study.requirements.map((requirement, index) =>
      card(
        "sheet-requirement",
        `${requirement.name} ${requirement.title === requirement.name ? "" : requirement.title}`.trim(),
        originOf(study, requirement, store.state.thresholds[index]!),
        resultsOf(store, index, designs),
      ),
    ),
    card("sheet-files", "Files", filesOf(study)),
  ].map((panel, place) => {
    // Several cards of one name have headings of their own.
    const heading = panel.querySelector("h2")!;
    heading.id = `heading-sheet-${place}`;
    panel.setAttribute("aria-labelledby", heading.id);
    return panel;
  });
}

function nameIn(model: Model, design: number): HTMLElement {
  const { id } = model.store.study.configurations[model.store.study.configuration[model.grouping.first[design]!]!]!;
  return el("span", {}, shortened(nameOf(model, design), MOST_NAME), " ", el("code", {}, id));
}

function isMoved({ atMost, atLeast }: Requirement, threshold: Threshold): boolean {
  return Boolean(threshold.off) || threshold.atMost !== atMost || threshold.atLeast !== atLeast;
}

function originOf(study: Study, requirement: Requirement, { atLeast, atMost, off }: Threshold): HTMLElement {
  const { title, unit } = study.metrics[requirement.metric]!;
  const bounds = [
    atLeast === null ? "" : `at least ${withUnit(number(atLeast), unit)}`,
    atMost === null ? "" : `at most ${withUnit(number(atMost), unit)}`,
  ];
  const rows: [string, string][] = [
    ...requirement.origin,
    ["bound", `${title}: ${bounds.filter(Boolean).join(", ")}${off ? " (switched off)" : ""}`],
    ...(requirement.draws
      ? [["must be met in", `${number(100 * requirement.metIn)}\u202f% of the draws`] as [string, string]]
      : []),
  ];
  return el("dl", { class: "facts" }, ...rows.flatMap(([name, text]) => [el("dt", {}, name), el("dd", {}, text)]));
}

const HEADS = [
  "Design",
  "Verdict",
  "Points",
  "pass",
  "fail",
  "not exercised",
  "failed to run",
  "Least margin",
  "Run",
  "Met in",
  "Runs that miss it",
];

function resultsOf(store: Store, index: number, designs: number[]): HTMLElement {
  const { study } = store;
  const hasRates = Boolean(study.requirements[index]!.draws);
  const heads = HEADS.filter((head) => hasRates || head !== "Met in");
  const rows = designs.map((design, place) => {
    const result = resultOf(store, groupingOf(study), index, design);
    const cells = [
      ...result.counts.slice(0, 4).map(group),
      marginOf(study, index, result),
      result.run < 0 ? "\u2013" : runButton(store, result.run, String(study.number[result.run])),
      ...(hasRates ? [rateOf(result)] : []),
      missingOf(study, result),
    ];
    const points = result.counts.slice(0, 4).reduce((sum, each) => sum + each, 0);
    return el(
      "tr",
      {},
      el("th", { scope: "row" }, designs.length > 1 ? String(place + 1) : "all"),
      el("td", { class: CLASSES[result.mark] }, `${SIGNS[result.mark]} ${WORDS[result.mark]}`),
      el("td", { class: "numeric" }, group(points)),
      ...cells.map((cell) => el("td", { class: "numeric" }, cell)),
    );
  });
  return el(
    "div",
    { class: "scroll", tabindex: 0, role: "region", "aria-label": `Results of requirement ${index + 1}` },
    el(
      "table",
      { class: "plain sheet-table" },
      el(
        "thead",
        {},
        el(
          "tr",
          {},
          ...heads.map((head, place) => el("th", { scope: "col", class: place > 1 ? "numeric" : "" }, head)),
        ),
      ),
      el("tbody", {}, ...rows),
    ),
  );
}

function marginOf(study: Study, index: number, { run, margin, error }: Result): string {
  if (run < 0) return "\u2013";
  const { unit } = study.metrics[study.requirements[index]!.metric]!;
  return withUnit(
    checked(margin, error, (value) => number(value, 4)),
    unit,
  );
}

function rateOf({ rate }: Result): string {
  if (!rate) return "\u2013";
  const [value, low, high] = [rate.value, rate.low, rate.high].map((share) => number(Math.round(100 * share)));
  return `${value}\u202f% (${low} \u2026 ${high})`;
}

function missingOf(study: Study, { missing }: Result): string {
  const shown = missing.slice(0, MOST_RUNS).map((run) => String(study.number[run]!));
  return shown.length
    ? shown.join(", ") + (missing.length > shown.length ? `, \u2026 (${group(missing.length)})` : "")
    : "none";
}

/** The study's fingerprint, its FMUs and its files, by their digests. */
function filesOf(study: Study): HTMLElement {
  const rows: [string, string][] = [
    ...study.facts.filter(
      ([name]) => ["study", "fingerprint", "dse", "runs", "noise"].includes(name) || name.startsWith("FMU "),
    ),
    ...(study.notes?.sources ?? []).map(({ kind, file, digest }): [string, string] => [
      `${kind} ${file}`,
      `SHA-256 ${digest}`,
    ]),
  ];
  return el(
    "dl",
    { class: "facts" },
    ...rows.flatMap(([name, text]) => [el("dt", {}, name), el("dd", {}, el("code", {}, text))]),
  );
}
