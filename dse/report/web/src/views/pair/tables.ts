// The tables of a decision.
import { type Case, type Decision, type Effect, isCertain } from "../../decision";
import { el } from "../../dom";
import { count, group, number, withUnit } from "../../format";
import type { Aim, DesignOrder } from "../../order";
import type { Interval } from "../../pairs";
import type { Store } from "../../store";
import type { Study } from "../../study";
import { drawsAt, SIGNS, type Threshold } from "../../verdicts";
import { choiceAt, configurationOf, differingPlaces, type Model } from "../designs/model";
import { shareText } from "../shared/margins";
import { runButton } from "../shared/runs";
import { classText } from "./words";

type Cells = (HTMLElement | string)[];

/** The first *texts* columns are words, the others numbers. */
function table(
  id: string,
  label: string,
  heads: string[],
  rows: { cells: Cells; kind?: string }[],
  texts = 1,
): HTMLElement {
  const numeric = (place: number): string => (place < texts ? "" : "numeric");
  return el(
    "div",
    { class: "scroll", tabindex: 0, role: "region", "aria-label": label },
    el(
      "table",
      { class: "plain", id },
      el(
        "thead",
        {},
        el("tr", {}, ...heads.map((head, place) => el("th", { scope: "col", class: numeric(place) }, head))),
      ),
      el(
        "tbody",
        {},
        ...rows.map(({ cells, kind }) =>
          el(
            "tr",
            { class: kind },
            ...cells.map((cell, place) =>
              place ? el("td", { class: numeric(place) }, cell) : el("th", { scope: "row" }, cell),
            ),
          ),
        ),
      ),
    ),
  );
}

/** What they choose differently, their values and properties. */
export function sidesTable(
  model: Model,
  aims: Aim[],
  { classes, slack }: DesignOrder,
  decision: Decision,
  first: number,
  second: number,
): HTMLElement {
  const { store, grouping } = model;
  const { study } = store;
  const [a, b] = [first, second].map((design) => configurationOf(model, design)) as [number, number];
  const chosen = differingPlaces(store)
    .map((place): [string, string, string] => [
      place,
      choiceAt(store, a, place) || "\u2013",
      choiceAt(store, b, place) || "\u2013",
    ])
    .filter(([, one, other]) => one !== other)
    .map((cells) => ({ cells: [...cells, ""] }));
  const values = study.variables
    .filter(({ role, lack }) => role === "design" && !lack.includes(a) && !lack.includes(b))
    .map(({ title, unit, text, values, labels }) => {
      const row = numbers(title, unit, text, values[grouping.first[first]!]!, values[grouping.first[second]!]!);
      return labels.length ? { ...row, cells: [...row.cells.slice(0, 3), ""] } : row;
    })
    .filter(({ differ }) => differ);
  const titles = new Set(aims.map(({ title }) => title));
  const properties = study.properties
    .filter(({ title }) => !titles.has(title))
    .map(({ title, unit, text, values }) => numbers(title, unit, text, values[a]!, values[b]!))
    .filter(({ differ }) => differ);
  const asked = aims.map(({ title, unit, text }, place) => numbers(title, unit, text, ...decision.objectives[place]!));
  const missed = classes.map(({ severity, judged, certain, doubtful }) => {
    const of = (design: number): string => {
      const unsure = doubtful[design] ? `, ${group(doubtful[design]!)} of them doubtful` : "";
      return `${group(certain[design]! + doubtful[design]!)} of ${group(judged[design]!)}${unsure}`;
    };
    return { cells: [`missed ${classText(severity, classes.length)}`, of(first), of(second), ""] };
  });
  return table(
    "pair-sides",
    "What A and B are",
    ["What", "A", "B", "A less B"],
    [
      { cells: ["configuration", code(study, a), code(study, b), ""] },
      ...missed,
      ...asked,
      { cells: ["least margin", shareText(slack[first]!), shareText(slack[second]!), ""] },
      ...chosen,
      ...values,
      ...properties,
    ],
  );
}

function code(study: Study, configuration: number): HTMLElement {
  return el("code", {}, study.configurations[configuration]!.id);
}

function numbers(title: string, unit: string, text: (value: number) => string, a: number, b: number) {
  const shown = (value: number): string => (Number.isNaN(value) ? "\u2013" : withUnit(text(value), unit));
  const difference = Number.isNaN(a - b) ? "\u2013" : withUnit(signed(a - b, 4), unit);
  return { cells: [title, shown(a), shown(b), difference], differ: !Object.is(a, b) };
}

/** Each requirement over all cases. */
export function totalsTable({ study, state }: Store, { cases, leading }: Decision): HTMLElement {
  const rows = study.requirements.flatMap(({ title }, index) => {
    const own = cases.filter(({ requirement }) => requirement === index);
    if (!own.length) return [];
    const sum = (of: (entry: Case) => number): number => own.reduce((all, entry) => all + of(entry), 0);
    const met = (side: 0 | 1): string => group(own.filter(({ margins }) => margins[side] >= 0).length);
    const lead = leading[index];
    const share = lead && Number.isFinite(lead.value) ? rateText(lead) : "\u2013";
    const counts = (["both", "first", "second", "neither"] as const).map((what) =>
      group(sum((entry) => entry.counts[what])),
    );
    return [
      {
        cells: [title, group(own.length), met(0), met(1), ...counts, share],
        kind: state.thresholds[index]!.off ? "off" : "",
      },
    ];
  });
  const heads = [
    "Requirement",
    "Verdicts",
    "A meets",
    "B meets",
    "Draws: both",
    "only A",
    "only B",
    "neither",
    "A of those that differ",
  ];
  return el(
    "div",
    {},
    table("pair-totals", "Requirements of A and B", heads, rows),
    el(
      "p",
      { class: "hint" },
      "Of the draws that only one of them meets, the share that A meets, with 95\u202f% confidence. 50\u202f%: they are alike.",
    ),
  );
}

export function casesTable(store: Store, { cases }: Decision, all: boolean): HTMLElement {
  const { study, state } = store;
  const differs = ({ counts, margins: [a, b] }: Case): boolean => counts.first + counts.second > 0 || a >= 0 !== b >= 0;
  const shown = [...(all ? cases : cases.filter(differs))].sort(
    (one, other) => Math.abs(other.counts.difference.value) - Math.abs(one.counts.difference.value),
  );
  const rows = shown.map((entry) => {
    const { requirement, runs, counts, margins } = entry;
    const { title, metric } = study.requirements[requirement]!;
    const { unit } = study.metrics[metric]!;
    const threshold = state.thresholds[requirement]!;
    const rate = (side: 0 | 1): HTMLElement => {
      const mark = store.judgement().each[requirement]![runs[side]]!;
      const found = drawsAt(study, requirement, runs[side], threshold);
      const draws = found ? rateText({ value: found.met / found.judged, low: found.low, high: found.high }) : "";
      return runButton(store, runs[side], `${SIGNS[mark]} ${draws}`.trim());
    };
    const { difference } = counts;
    return {
      cells: [
        title,
        placeText(study, runs[0]) || "\u2013",
        rate(0),
        rate(1),
        el("span", { class: "interval" }, points(difference), bar(difference)),
        withUnit(
          `${signed(counts.margin, 3)}${counts.error ? ` \u00b1\u202f${number(1.96 * counts.error, 2)}` : ""}`,
          unit,
        ),
        between(threshold, margins, unit),
      ],
      kind: isCertain(difference) ? "certain" : "",
    };
  });
  const heads = [
    "Requirement",
    "Condition",
    "A",
    "B",
    "Rate of A less B",
    "Margin of A less B",
    "A bound that only one meets",
  ];
  return el(
    "div",
    {},
    rows.length
      ? table("pair-cases", "A and B verdict by verdict", heads, rows, 2)
      : el("p", { class: "muted" }, "None of their verdicts or draws differ."),
    el(
      "p",
      { class: "hint" },
      `${group(shown.length)} of ${count(cases.length, "verdict")}. Rates and their differences are with 95\u202f% confidence, each by itself: of many, one in twenty may differ by chance. Bold: certain.`,
    ),
  );
}

/** The conditions of a run; "" if the study imposes none. */
export function placeText(study: Study, run: number): string {
  const given = study.variables.filter(({ role }) => role !== "design");
  return given.map(({ title, unit, text, values }) => `${title} ${withUnit(text(values[run]!), unit)}`).join(", ");
}

/** Between which bounds only one of them meets a requirement. */
function between({ atLeast, atMost }: Threshold, [a, b]: [number, number], unit: string): string {
  if (Number.isNaN(a - b) || a === b) return "none";
  const [one, other] = a > b ? [a, b] : [b, a];
  const name = a > b ? "A" : "B";
  if (atLeast !== null && atMost !== null)
    return `${name}: ${withUnit(`${signed(-one, 3)} \u2026 ${signed(-other, 3)}`, unit)} at both ends`;
  const ends = atLeast !== null ? [atLeast + other, atLeast + one] : [atMost! - one, atMost! - other];
  return `${name}: ${withUnit(`${number(ends[0]!, 3)} \u2026 ${number(ends[1]!, 3)}`, unit)}`;
}

const WIDE = 72;
const HIGH = 12;

function bar({ value, low, high }: Interval): Element {
  const at = (share: number): number => ((1 + share) / 2) * WIDE;
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  for (const [name, text] of [
    ["viewBox", `0 0 ${WIDE} ${HIGH}`],
    ["width", WIDE],
    ["height", HIGH],
    ["aria-hidden", "true"],
  ] as const)
    svg.setAttribute(name, String(text));
  for (const [kind, d] of [
    ["axis", `M${WIDE / 2} 0V${HIGH}`],
    ["reach", `M${at(low)} ${HIGH / 2}H${Math.max(at(high), at(low) + 1)}`],
    ["value", `M${at(value) - 1.5} 2H${at(value) + 1.5}V${HIGH - 2}H${at(value) - 1.5}Z`],
  ] as const) {
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    path.setAttribute("class", kind);
    path.setAttribute("d", d);
    svg.append(path);
  }
  return svg;
}

/** Of the effects those that are certain, the largest first; the others by name. */
export function effectsTable(study: Study, { effects }: Decision): HTMLElement[] {
  const shown = effects.filter(({ change }) => change.low > 0 || change.high < 0);
  const names = [...new Set(effects.map(({ variable }) => variable))];
  const without = names.filter((variable) => !shown.some((effect) => effect.variable === variable));
  const rows = shown.map((effect) => {
    const { variable, requirement, values, levels, change } = effect;
    const { unit } = study.metrics[study.requirements[requirement]!.metric]!;
    const { title, text, unit: own } = study.variables[variable]!;
    const at = (level: number): string =>
      `${withUnit(intervalText(levels[level]!), unit)} at ${withUnit(text(values[level]!), own)}`;
    const [least, most] = ends(effect);
    return {
      cells: [
        title,
        study.requirements[requirement]!.title,
        at(least),
        at(most),
        withUnit(intervalText(change), unit),
        reverses(levels) ? "yes" : "no",
      ],
    };
  });
  const heads = ["Varied number", "Margin of", "A less B, smallest", "A less B, largest", "Change", "Reverses"];
  const nothing = names.length
    ? "In none of the numbers that the study varies is a change of the difference certain."
    : "The study varies nothing that both designs have in common.";
  return [
    rows.length ? table("pair-effects", "Table of effects on the difference", heads, rows, 2) : el("p", {}, nothing),
    el(
      "p",
      { class: "hint" },
      [
        "Mean difference of the margins over all other conditions, with 95\u202f% confidence; with more than twelve values, on a straight line through them.",
        without.length && rows.length
          ? `No certain change with ${without.map((variable) => study.variables[variable]!.title).join(", ")}.`
          : "",
      ].join(" "),
    ),
  ];
}

function ends({ levels, isLine }: Effect): [number, number] {
  const values = levels.map(({ value }) => value);
  return isLine ? [0, 1] : [values.indexOf(Math.min(...values)), values.indexOf(Math.max(...values))];
}

/** Whether each design is better at some level, for certain. */
export function reverses(levels: Interval[]): boolean {
  return levels.some(({ low }) => low > 0) && levels.some(({ high }) => high < 0);
}

/** The numbers of the parts of either design that are marked as assumed; null if that was not kept. */
export function assumedNumbers(model: Model, first: number, second: number): string[] | null {
  const { study } = model.store;
  const marked = study.notes?.assumed;
  if (!marked) return null;
  const parts = [first, second].flatMap((design) => {
    const { picture, parts } = study.configurations[configurationOf(model, design)]!;
    return study.pictures[picture]?.parts.map(([path], place): [string, string] => [path, parts[place]!]) ?? [];
  });
  const names = parts.flatMap(([path, component]) =>
    marked.filter((each) => each.startsWith(`${component}.`)).map((each) => path + each.slice(component.length)),
  );
  return [...new Set(names)].sort();
}

/** Which of them the study varies. */
export function assumedText(study: Study, assumed: string[] | null): string {
  if (!assumed) return "Which numbers are assumed was not kept with this study.";
  if (!assumed.length) return "No number of these designs is marked as assumed.";
  const varied = assumed.filter((name) => study.variables.some((variable) => variable.name === name));
  return varied.length
    ? `Of ${count(assumed.length, "number")} of these designs that are marked as assumed, the study varies ${varied.join(", ")}.`
    : `The study varies none of the ${count(assumed.length, "number")} of these designs that are marked as assumed: how the difference depends on them is not known.`;
}

export function assumedList(study: Study, assumed: string[] | null): HTMLElement {
  const text = assumedText(study, assumed);
  return assumed?.length
    ? el("details", { id: "pair-assumed" }, el("summary", {}, text), el("p", { class: "hint" }, assumed.join(", ")))
    : el("p", { id: "pair-assumed" }, text);
}

function signed(value: number, digits: number): string {
  return `${value > 0 ? "+" : ""}${number(value, digits)}`;
}

function rateText({ value, low, high }: Interval): string {
  const percent = (share: number): string => number(Math.round(100 * share));
  return `${percent(value)}\u202f% (${percent(low)} \u2026 ${percent(high)})`;
}

/** Differences of rates, in percentage points. */
function points({ value, low, high }: Interval): string {
  const shown = (share: number): string => signed(Math.round(100 * share), 3);
  return low === high ? `${shown(value)}\u202f%` : `${shown(value)}\u202f% (${shown(low)} \u2026 ${shown(high)})`;
}

function intervalText({ value, low, high }: Interval): string {
  if (Number.isNaN(low)) return signed(value, 3);
  return low === high ? signed(value, 3) : `${signed(value, 3)} (${number(low, 2)} \u2026 ${number(high, 2)})`;
}
