// Which design to take: the first in the order, the next one, and what decides between them. `dse findings` has the same
// sentences; both are tested with tests/order_cases.json.
import { setSetting } from "../../actions";
import { type Decision, decide } from "../../decision";
import { card, el } from "../../dom";
import { count, group, withUnit } from "../../format";
import { groupingOf } from "../../grouping";
import { type Aim, aheadBy, aimsOf, type DesignOrder, orderAt } from "../../order";
import type { Store } from "../../store";
import type { Study } from "../../study";
import { FAIL, FAILED, isDoubtful, PASS } from "../../verdicts";
import { choiceAt, configurationOf, createModel, differingPlaces, type Model, nameOf } from "../designs/model";
import { SETTING } from "../pair/pair";
import { assumedNumbers, assumedText, placeText, reverses } from "../pair/tables";
import { certaintyOf, classText, orderSentence, orderText } from "../pair/words";
import { allocationTables } from "../shared/allocation";
import { shareText } from "../shared/margins";
import { openRun } from "../shared/runs";

const MOST_CASES = 2;
const MOST_CHANGES = 6;
const VERDICT =
  "A verdict is that on a requirement at a condition. It is doubtful if more draws or finer numerics may change it.";

/** The box, for a study that has a choice. */
export function createChoice(store: Store): HTMLElement[] {
  const { study } = store;
  if (!study.requirements.length || groupingOf(study).size < 2) return [];
  const model = createModel(store);
  const body = el("div", { class: "choice-box", id: "choice", "aria-live": "polite" });
  const draw = (): void => body.replaceChildren(...contentOf(model));
  draw();
  store.subscribe((_, changed) => {
    if (changed.has("thresholds")) draw();
  });
  return [card("choice", "Which design", body)];
}

function contentOf(model: Model): HTMLElement[] {
  const { store, grouping } = model;
  const found = choiceOf(model);
  if (!found) return [el("p", {}, "No design was run at all conditions, so that none can be named.")];
  const { first, next, name, lines } = found;
  const against = (): void => {
    setSetting(store, SETTING, [first, next].map((design) => store.study.number[grouping.first[design]!]!).join());
    store.set({ view: "pair" });
  };
  const worst = model.standing().deciding[first]!;
  const configuration = store.study.configurations[configurationOf(model, first)]!;
  return [
    el("h3", { id: "choice-name" }, name),
    el("dl", { class: "facts" }, ...lines.flatMap(([label, text]) => [el("dt", {}, label), el("dd", {}, text)])),
    ...allocationTables(configuration),
    el(
      "div",
      { class: "row" },
      el("button", { id: "choice-against", type: "button", click: against }, "A against B: this design and the next"),
      el(
        "button",
        { id: "choice-worst", type: "button", click: () => openRun(store, worst) },
        `Its worst run: ${store.study.number[worst]}`,
      ),
    ),
  ];
}

interface Choice {
  first: number;
  next: number;
  name: string;
  /** Each with what it is about. */
  lines: [string, string][];
}

/** The first design with its result, the next one with what decides, what is cheaper, how sure it is, and the order;
 * null if no design was run at all conditions. */
export function choiceOf(model: Model): Choice | null {
  const { store } = model;
  const { study, state } = store;
  const [aims, order] = [aimsOf(study), orderAt(store)];
  const [first, next] = order.ranked as unknown as [number, number];
  if (order.keys[0]![first]) return null;
  const decision = decide(study, state.thresholds, store.judgement(), aims, order, first, next);
  const pair: [number, number] = [first, next];
  const assumed = assumedNumbers(model, first, next);
  const { id } = study.configurations[configurationOf(model, first)]!;
  const sure = [
    sureness(store, decision, first),
    certaintyOf(study, decision),
    ...reversed(study, decision, assumed),
    assumedText(study, assumed),
  ];
  const [what, ...missed] = result(model, order, decision, first);
  const why = orderText(aims, order, decision, pair, ["This design", "The next one"]);
  return {
    first,
    next,
    name: `${nameOf(model, first)} (${id}, run ${study.number[model.grouping.first[first]!]})`,
    lines: [
      ["result", what!],
      ...missed.map((text): [string, string] => ["misses", text]),
      ["values", values(model, aims, order, first)],
      ["next", `${changes(model, first, next) || id}. ${why}${where(store, order, decision, pair)}`],
      ...cheaper(model, order, first).map((text): [string, string] => ["cheaper", text]),
      ["how sure", sure.join(" ")],
      ["order", `${orderSentence(aims, order)} ${VERDICT}`],
    ],
  };
}

function result(model: Model, { classes, keys, place }: DesignOrder, decision: Decision, first: number): string[] {
  const { store } = model;
  const { study, state } = store;
  const standing = model.standing();
  const used = study.requirements.map((_, index) => index).filter((index) => !state.thresholds[index]!.off);
  const many = used.length === 2 ? "both requirements" : `all ${used.length} requirements`;
  const all = used.length === 1 ? "the requirement" : many;
  const { conditions } = groupingOf(study);
  const at = conditions > 1 ? ` in ${conditions === 2 ? "both" : `all ${group(conditions)}`} conditions` : "";
  if (!decision.missed[0]) {
    const columns = keys.slice(0, 1 + 2 * classes.length);
    const feasible = Array.from(place).filter((_, design) => columns.every((column) => !column[design])).length;
    return [
      `It meets ${all}${at}: ${count(decision.judged[0], "verdict")}. ${group(feasible)} of ${group(place.length)} designs do.`,
    ];
  }
  const parts = classes.map(
    ({ severity, judged, certain, doubtful }) =>
      `${group(certain[first]! + doubtful[first]!)} of ${group(judged[first]!)} ${classText(severity, classes.length)}`,
  );
  const missed = used.flatMap((index): string[] => {
    const runs = missesOf(store, index, first);
    if (!runs.length)
      return standing.worst[index]![first]! < 0 ? [`${study.requirements[index]!.title}: no run exercises it.`] : [];
    const doubtful = runs.filter((run) => isDoubtful(study, index, run, state.thresholds[index]!)).length;
    const how = doubtful === runs.length ? " (doubtful)" : doubtful ? ` (${doubtful} doubtful)` : "";
    return [`${study.requirements[index]!.title}${how}${casesText(study, runs)}.`];
  });
  return [`No design meets ${all}${at}. This one is the first in the order: it misses ${parts.join(", ")}.`, ...missed];
}

/** The runs of a design that miss a requirement. */
function missesOf(store: Store, index: number, design: number): number[] {
  const { rows, start } = groupingOf(store.study);
  const marks = store.judgement().each[index]!;
  return Array.from(rows.subarray(start[design]!, start[design + 1]!)).filter(
    (run) => marks[run] === FAIL || marks[run] === FAILED,
  );
}

/** The conditions of the first of *runs*. */
function casesText(study: Study, runs: number[]): string {
  const cases = runs
    .slice(0, MOST_CASES)
    .map((run) => placeText(study, run))
    .filter(Boolean);
  const rest = runs.length - MOST_CASES;
  return cases.length ? `, at ${cases.join("; ")}${rest > 0 ? ` and ${count(rest, "more condition")}` : ""}` : "";
}

/** The cases in which only the next design misses a requirement of the class that decides. */
function where(store: Store, { classes }: DesignOrder, { by }: Decision, [first, next]: [number, number]): string {
  const { study, state } = store;
  const level = classes[(by - 1) >> 1]?.level;
  for (const [index, { title, level: own }] of study.requirements.entries()) {
    if (own !== level || state.thresholds[index]!.off) continue;
    const mine = new Set(missesOf(store, index, first).map((run) => placeText(study, run)));
    const runs = missesOf(store, index, next).filter((run) => !mine.has(placeText(study, run)));
    if (runs.length) return ` It alone misses ${title}${casesText(study, runs)}.`;
  }
  return "";
}

/** What *next* has and *first* has not. */
function changes(model: Model, first: number, next: number): string {
  const { store, grouping } = model;
  const { study } = store;
  const [a, b] = [first, next].map((design) => configurationOf(model, design)) as [number, number];
  const [mine, theirs] = [grouping.first[first]!, grouping.first[next]!];
  const found = differingPlaces(store)
    .filter((place) => choiceAt(store, a, place) !== choiceAt(store, b, place))
    .map(
      (place) => `${place} ${choiceAt(store, b, place) || "none"} instead of ${choiceAt(store, a, place) || "none"}`,
    );
  for (const { role, lack, title, unit, text, values } of study.variables)
    if (role === "design" && !lack.includes(b) && (lack.includes(a) || values[mine] !== values[theirs]))
      found.push(`${title} ${withUnit(text(values[theirs]!), unit)}`);
  const rest = found.length - MOST_CHANGES;
  return found.slice(0, MOST_CHANGES).join(", ") + (rest > 0 ? ` and ${rest} more` : "");
}

function values(model: Model, aims: Aim[], { slack }: DesignOrder, first: number): string {
  const told = aims.map((aim) => `${aim.title} ${withUnit(aim.text(aim.values[first]!), aim.unit)}`);
  const price = priceOf(model.store.study);
  if (price && !aims.some(({ title }) => title === price.title)) told.push(`${price.title} ${costText(model, first)}`);
  const margin = slack[first]!;
  if (Number.isFinite(margin)) told.push(`least margin ${shareText(margin)} of the bound`);
  const text = told.join(", ") || "its margins are undefined";
  return `${text[0]!.toUpperCase()}${text.slice(1)}.`;
}

/** The first price that each configuration has. */
function priceOf({ properties }: Study): Study["properties"][number] | undefined {
  return properties.find(({ isPrice, values }) => isPrice && values.every((value) => !Number.isNaN(value)));
}

function costText(model: Model, design: number): string {
  const { unit, text, values } = priceOf(model.store.study)!;
  return withUnit(text(values[configurationOf(model, design)]!), unit);
}

/** The cheapest design with as few missed verdicts of each class. */
function cheaper(model: Model, { classes, keys, ranked }: DesignOrder, first: number): string[] {
  const { study } = model.store;
  const price = priceOf(study);
  if (!price) return [];
  const cost = (design: number): number => price.values[configurationOf(model, design)]!;
  const columns = keys.slice(0, 1 + 2 * classes.length);
  let best = first;
  for (const design of ranked)
    if (
      cost(design) < cost(best) &&
      !aheadBy(
        columns.map((column) => [column[first]!, column[design]!]),
        0,
        1,
      )[0]
    )
      best = design;
  if (best === first) return [];
  const { id } = study.configurations[configurationOf(model, best)]!;
  const run = study.number[model.grouping.first[best]!];
  return [
    `${changes(model, first, best)} (${id}, run ${run}): as few missed verdicts of each severity for ${costText(model, best)} instead of ${costText(model, first)}.`,
  ];
}

function sureness(store: Store, { judged }: Decision, first: number): string {
  const { study, state } = store;
  const { rows, start } = groupingOf(study);
  const { each } = store.judgement();
  let unsure = 0;
  for (const run of rows.subarray(start[first]!, start[first + 1]!))
    for (const [index, threshold] of state.thresholds.entries()) {
      const mark = each[index]![run]!;
      const isJudged = mark === PASS || mark === FAIL || mark === FAILED;
      if (!threshold.off && isJudged && isDoubtful(study, index, run, threshold)) unsure++;
    }
  return `${unsure ? group(unsure) : "None"} of its ${count(judged[0], "verdict")} ${unsure > 1 ? "are" : "is"} doubtful.`;
}

/** The assumed numbers that alter which of both is better. */
function reversed(study: Study, { effects }: Decision, assumed: string[] | null): string[] {
  return effects
    .filter(({ variable, levels }) => assumed?.includes(study.variables[variable]!.name) && reverses(levels))
    .map(
      ({ variable, requirement }) =>
        `Which one has the larger margin of ${study.requirements[requirement]!.title} depends on the assumed ${study.variables[variable]!.title}.`,
    );
}
