// What is asked of a design: margin to keep, and criteria with a direction and a weight; and which designs answer.
import { selectRun } from "../../actions";
import { choose, el, field } from "../../dom";
import { count, group, percent, withUnit } from "../../format";
import { axisLabel } from "../../study";
import { PASS } from "../../verdicts";
import { SHARE_OF } from "../shared/margins";
import { type Criterion, type Model, nameOf, subscribeCalmly, togglePick } from "./model";
import { designColumns, senseOf } from "./values";

export function createCriteria(model: Model): HTMLElement {
  const demand = createDemand(model);
  const list = el("div", { class: "criteria" });
  const answers = el("ul", { class: "answers", "aria-live": "polite" });
  const drawList = (): void => {
    const focused = (document.activeElement as HTMLElement | null)?.id;
    list.replaceChildren(...rows(model), adder(model));
    if (focused) document.getElementById(focused)?.focus();
  };
  const drawAnswers = (): void => answers.replaceChildren(...answersOf(model));
  model.subscribe((changed) => {
    // A slider that is being dragged must stay the same element.
    if (changed.has("criteria") && !document.activeElement?.classList.contains("weighing")) drawList();
  });
  subscribeCalmly(model, (changed) => {
    if (["criteria", "demand", "thresholds", "brushes"].some((key) => changed.has(key as "demand"))) drawAnswers();
  });
  drawList();
  drawAnswers();
  return el("div", { class: "ask" }, ...(model.store.study.requirements.length ? [demand] : []), list, answers);
}

function createDemand(model: Model): HTMLElement {
  const reading = el("output", { for: "demand" });
  const slider = el("input", {
    id: "demand",
    type: "range",
    min: 0,
    max: 50,
    step: 1,
    value: 100 * model.choices.demand,
    "aria-label": "Margin demanded of every requirement, in percent",
    input: () => model.set({ demand: Number(slider.value) / 100 }),
  });
  const show = (): void => {
    const value = Math.round(100 * model.choices.demand);
    slider.value = String(value);
    reading.textContent = `${value}\u202f%`;
    slider.setAttribute("aria-valuetext", `${value} %`);
  };
  model.subscribe((changed) => {
    if (changed.has("demand")) show();
  });
  show();
  const hint = `The share that is kept as margin: ${SHARE_OF}.`;
  return el(
    "div",
    { class: "demand" },
    el("label", { for: "demand", title: hint }, "Margin demanded"),
    slider,
    reading,
  );
}

function rows(model: Model): HTMLElement[] {
  const { criteria } = model.choices;
  const change = (index: number, patch: Partial<Criterion>): void =>
    model.set({ criteria: criteriaWith(model, index, patch) });
  return criteria.map(({ column, maximize, weight }, index) => {
    const { title, unit } = model.column(column);
    const way = choose(
      [
        ["min", "minimise"],
        ["max", "maximise"],
      ],
      maximize ? "max" : "min",
      (value) => change(index, { maximize: value === "max" }),
    );
    way.id = `way-${column}`;
    way.setAttribute("aria-label", `Direction of ${title}`);
    const slider = el("input", {
      id: `weight-${column}`,
      class: "weighing",
      type: "range",
      min: 0,
      max: 10,
      step: 1,
      value: weight,
      "aria-label": `Weight of ${title}`,
      input: () => {
        change(index, { weight: Number(slider.value) });
        slider
          .closest(".criteria")!
          .querySelectorAll("output")
          .forEach((output, other) => (output.textContent = share(model, other)));
      },
    });
    return el(
      "div",
      { class: "criterion" },
      el("span", { class: "name" }, axisLabel({ title, unit })),
      way,
      slider,
      el("output", {}, share(model, index)),
      el(
        "button",
        {
          type: "button",
          class: "drop",
          "aria-label": `Drop ${title}`,
          click: () => model.set({ criteria: criteria.filter((_, place) => place !== index) }),
        },
        "\u00d7",
      ),
    );
  });
}

function criteriaWith({ choices }: Model, index: number, patch: Partial<Criterion>): Criterion[] {
  return choices.criteria.map((criterion, place) => (place === index ? { ...criterion, ...patch } : criterion));
}

function share({ choices }: Model, index: number): string {
  const total = choices.criteria.reduce((sum, { weight }) => sum + weight, 0);
  return percent(choices.criteria[index]!.weight, total);
}

function adder(model: Model): HTMLElement {
  const { criteria } = model.choices;
  const others = designColumns(model.store.study).filter(({ key }) => !criteria.some(({ column }) => column === key));
  const options: [string, string][] = [
    ["", "add a criterion \u2026"],
    ...others.map((column): [string, string] => [column.key, axisLabel(column)]),
  ];
  const select = choose(options, "", (column) => {
    if (column)
      model.set({
        criteria: [...model.choices.criteria, { column, maximize: senseOf(model.store, column) === "max", weight: 5 }],
      });
  });
  select.id = "add-criterion";
  return field("Criteria, with their weight in the score", select);
}

/** How many designs do, and the best of them by each criterion and by all. */
function answersOf(model: Model): HTMLElement[] {
  const { choices, grouping } = model;
  const { mark } = model.standing();
  const within = model.within();
  const feasible: number[] = [];
  for (let design = 0; design < mark.length; design++)
    if (mark[design] === PASS && (within?.[design] ?? 1)) feasible.push(design);
  const margin = choices.demand ? ` with ${Math.round(100 * choices.demand)}\u202f% margin` : "";
  const amongst = within ? " within the brushes" : "";
  const every = model.store.state.thresholds.some(({ off }) => off)
    ? "every requirement that is on"
    : "every requirement";
  const verb = feasible.length === 1 ? "meets" : "meet";
  const head = el(
    "li",
    { id: "feasible-designs" },
    el("b", {}, group(feasible.length)),
    ` of ${count(grouping.size, "design")} ${verb} ${every}${margin}${amongst}.`,
  );
  if (!feasible.length)
    return [
      head,
      el("li", { class: "muted" }, "The leader board lists all designs in their order: the first one misses least."),
    ];
  const best = choices.criteria.flatMap(({ column, maximize }) => {
    const { title, unit, values, text } = model.column(column);
    const design = first(feasible, (one) => (maximize ? -values[one]! : values[one]!));
    return design < 0
      ? []
      : [answer(model, design, `${maximize ? "Most" : "Least"} ${title}`, withUnit(text(values[design]!), unit))];
  });
  const scores = model.scores();
  const top = first(feasible, (one) => -scores[one]!);
  return [
    head,
    ...best,
    ...(top >= 0 && choices.criteria.length > 1 ? [answer(model, top, "Best score", scores[top]!.toFixed(3))] : []),
  ];
}

function answer(model: Model, design: number, what: string, value: string): HTMLElement {
  return el(
    "li",
    {},
    el("span", { class: "what" }, what),
    el("b", {}, value),
    el(
      "button",
      { type: "button", class: "link", click: () => selectRun(model.store, model.standing().deciding[design]!) },
      nameOf(model, design),
    ),
    el(
      "button",
      {
        type: "button",
        class: "link",
        "aria-label": `Compare ${nameOf(model, design)}`,
        click: () => togglePick(model, design),
      },
      "compare",
    ),
  );
}

/** The one with the smallest *value*, the earlier of two; -1 where none has a value. */
function first(designs: number[], value: (design: number) => number): number {
  let best = -1;
  let least = Infinity;
  for (const design of designs) {
    if (!(value(design) < least)) continue;
    least = value(design);
    best = design;
  }
  return best;
}
