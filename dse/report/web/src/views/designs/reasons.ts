// Why the selected design is out, by how much, and what would have to change.
import { selectRun } from "../../actions";
import { el } from "../../dom";
import { number, percent, withUnit } from "../../format";
import { variablesOf } from "../../grouping";
import { badge } from "../../panels/selected";
import { CLASSES, FAIL, PASS, SIGNS, WORDS } from "../../verdicts";
import { marginWithShare, shareText } from "../shared/margins";
import { short } from "./ellipsis";
import { configurationOf, MOST_COMPARED, type Model, nameOf, subscribeCalmly } from "./model";
import { type Change, changesBetween, nearestDesign } from "./neighbours";

export function createReasons(model: Model): HTMLElement {
  const box = el("div", { class: "reasons", id: "reasons" });
  const draw = (): void => box.replaceChildren(...reasonsOf(model));
  subscribeCalmly(model, (changed) => {
    if (["selected", "demand", "thresholds", "brushes", "criteria"].some((key) => changed.has(key as "demand"))) draw();
  });
  draw();
  return box;
}

function reasonsOf(model: Model): HTMLElement[] {
  const { store, grouping, choices } = model;
  const { study, state } = store;
  if (state.selected < 0) return [el("p", { class: "muted" }, "No design is selected.")];
  const design = grouping.of[state.selected]!;
  const { mark, slack, deciding } = model.standing();
  const verdict = mark[design]!;
  const margin = choices.demand ? ` with ${Math.round(100 * choices.demand)}\u202f% margin` : "";
  const said =
    verdict === PASS
      ? `It meets every requirement${margin}${Number.isNaN(slack[design]!) ? "." : `; the least margin is ${shareText(slack[design]!)}.`}`
      : `It is out: ${sentences(model, design).join("; ")}.`;
  const problem = study.problems.get(deciding[design]!);
  const parts = [
    el("h3", {}, nameOf(model, design), badge(verdict)),
    el("p", { class: "said" }, said),
    ...(problem && !study.done[deciding[design]!] ? [el("p", { class: "problem" }, problem)] : []),
    ...(study.requirements.length ? [requirementTable(model, design)] : []),
  ];
  return verdict === PASS ? parts : [...parts, ...waysOut(model, design)];
}

function sentences(model: Model, design: number): string[] {
  const { store, choices, grouping } = model;
  const { study, state } = store;
  const { each, margins } = model.standing();
  const runs = grouping.rows.subarray(grouping.start[design]!, grouping.start[design + 1]!);
  const failed = runs.reduce((sum, run) => sum + (study.done[run] ? 0 : 1), 0);
  const told = failed ? [`${failed} of its ${runs.length} runs failed to run`] : [];
  study.requirements.forEach(({ title }, index) => {
    if (state.thresholds[index]!.off) return;
    const mark = each[index]![design]!;
    if (mark === FAIL) {
      const by = margins[index]![design]!;
      told.push(
        Number.isNaN(by)
          ? `\u201c${title}\u201d has no value`
          : by < 0
            ? `\u201c${title}\u201d is missed`
            : `\u201c${title}\u201d is met, but with less than ${Math.round(100 * choices.demand)}\u202f% margin`,
      );
    } else if (mark !== PASS && !failed) told.push(`no run exercised \u201c${title}\u201d`);
  });
  if (!grouping.whole[design]) told.push("it was not run at all conditions");
  return told;
}

function requirementTable(model: Model, design: number): HTMLElement {
  const { store, grouping } = model;
  const { study, state } = store;
  const { each, margins, worst } = model.standing();
  const conditions = [...variablesOf(study, "condition"), ...variablesOf(study, "uncertain")];
  const several = grouping.start[design + 1]! - grouping.start[design]! > 1;
  const rows = study.requirements.map(({ title, metric }, index) => {
    const threshold = state.thresholds[index]!;
    const { unit, values, text } = study.metrics[metric]!;
    const run = worst[index]![design]!;
    const by = margins[index]![design]!;
    const bounds = [
      threshold.atMost === null ? "" : `\u2264\u202f${number(threshold.atMost)}`,
      threshold.atLeast === null ? "" : `\u2265\u202f${number(threshold.atLeast)}`,
    ]
      .filter(Boolean)
      .join(", ");
    const mark = each[index]![design]!;
    const at =
      run < 0 || !several
        ? ""
        : conditions
            .map(
              ({ title: name, unit: symbol, values: column, text: shown }) =>
                `${name} ${withUnit(shown(column[run]!), symbol)}`,
            )
            .join(", ");
    return el(
      "tr",
      { class: threshold.off ? "off" : "" },
      el("th", { scope: "row" }, title, threshold.off ? " (off)" : "", at && el("span", { class: "muted at" }, at)),
      el("td", {}, run < 0 ? "\u2013" : withUnit(text(values[run]!), unit)),
      el("td", {}, withUnit(bounds, unit)),
      el("td", {}, Number.isNaN(by) ? "\u2013" : marginWithShare(study, index, threshold, by)),
      el("td", { class: `verdict ${CLASSES[mark]}` }, `${SIGNS[mark]} ${WORDS[mark]}`),
    );
  });
  const head = ["Requirement", several ? "Worst value" : "Value", "Bound", "Margin", "Verdict"].map((text) =>
    el("th", { scope: "col" }, text),
  );
  return el(
    "div",
    { class: "scroll" },
    el("table", { class: "metrics" }, el("thead", {}, el("tr", {}, ...head)), el("tbody", {}, ...rows)),
  );
}

/** The nearest feasible design of the same configuration, and if that is another, the nearest of any. */
function waysOut(model: Model, design: number): HTMLElement[] {
  const { store, grouping, choices } = model;
  const { study } = store;
  const among = model.standing().mark.map((mark) => (mark === PASS ? 1 : 0));
  const near = nearestDesign(study, grouping, design, among, true);
  const any = near >= 0 ? near : nearestDesign(study, grouping, design, among, false);
  const heading = el("h4", {}, "What would have to change");
  const margin = choices.demand ? ` with ${Math.round(100 * choices.demand)}\u202f% margin` : "";
  if (any < 0)
    return [
      heading,
      el("p", { class: "muted" }, `None of the designs of this study meets every requirement${margin}.`),
    ];
  const decided = variablesOf(study, "design").some(({ lack }) => !lack.includes(configurationOf(model, design)));
  const alone =
    near < 0 && decided && study.configurations.length > 1
      ? [el("p", { class: "said" }, "No simulated values of its design variables are sufficient on their own.")]
      : [];
  const changes = changesBetween(study, grouping, design, any);
  const pick = (): void =>
    model.set({
      picked: [
        ...new Set([
          ...choices.picked.filter((one) => one !== design && one !== any).slice(-(MOST_COMPARED - 2)),
          design,
          any,
        ]),
      ],
    });
  return [
    heading,
    ...alone,
    el(
      "p",
      { class: "said" },
      near >= 0
        ? "The nearest design that is feasible, of the same configuration, is "
        : "The nearest design that is feasible is ",
      el(
        "button",
        {
          type: "button",
          class: "link",
          id: "nearest",
          click: () => selectRun(store, model.standing().deciding[any]!),
        },
        nameOf(model, any),
      ),
      ":",
    ),
    el("ul", { class: "changes" }, ...changes.map(changeItem)),
    el("button", { type: "button", id: "compare-nearest", click: pick }, "Compare both"),
  ];
}

function changeItem({ title, from, to, share }: Change): HTMLElement {
  const way = Number.isNaN(share)
    ? ""
    : ` (${share > 0 ? "up" : "down"} by ${percent(Math.abs(share), 1)} of its range)`;
  return el("li", {}, el("b", {}, short(title)), " ", short(from), " \u2192 ", short(to), way);
}
