// What an alternative buys: for each place the designs that chose it, as a box of one column and a share of feasible ones.
import { choose, el, field } from "../../dom";
import { count, group, percent } from "../../format";
import { axisLabel } from "../../study";
import { PASS } from "../../verdicts";
import { choiceAt, configurationOf, differingPlaces, type Model, subscribeCalmly } from "./model";
import { designColumns } from "./values";

const WIDE = 1000;
const HIGH = 22;

/** Five numbers of a sample: its ends, quartiles (linear between neighbours, as numpy) and median. */
export interface Box {
  low: number;
  first: number;
  median: number;
  third: number;
  high: number;
  count: number;
}

export function createAlternatives(model: Model): HTMLElement {
  const columns = designColumns(model.store.study).map((column): [string, string] => [column.key, axisLabel(column)]);
  const over = choose(columns, model.choices.boxes, (boxes) => model.set({ boxes }));
  over.id = "boxes-over";
  const among = choose(
    [
      ["all", "all designs"],
      ["feasible", "feasible designs"],
    ],
    model.choices.among,
    (value) => model.set({ among: value as "all" | "feasible" }),
  );
  among.id = "boxes-among";
  const box = el("div", { class: "places" });
  const draw = (): void => {
    over.value = model.choices.boxes;
    among.value = model.choices.among;
    box.replaceChildren(...tables(model));
  };
  subscribeCalmly(model, (changed) => {
    if (["boxes", "among", "criteria", "demand", "thresholds", "brushes"].some((key) => changed.has(key as "boxes")))
      draw();
  });
  draw();
  const hint =
    "Box: the middle half of the designs, with the median; whiskers: the least and the greatest. Other choices differ too: the plot shows association with an alternative, not its own effect.";
  return el(
    "div",
    { class: "alternatives" },
    el("div", { class: "controls" }, el("div", { class: "row" }, field("Boxes of", over), field("Over", among))),
    box,
    el("p", { class: "hint" }, hint),
  );
}

function tables(model: Model): HTMLElement[] {
  const { store, choices, grouping } = model;
  const column = model.column(choices.boxes);
  const { mark } = model.standing();
  const within = model.within();
  const designs: number[] = [];
  for (let design = 0; design < grouping.size; design++) if (within?.[design] ?? 1) designs.push(design);
  const wanted = choices.among === "all" ? designs : designs.filter((design) => mark[design] === PASS);
  const sound = wanted.filter((design) => Number.isFinite(column.values[design]!));
  const span = boxOf(sound.map((design) => column.values[design]!));
  const places = differingPlaces(store);
  if (!places.length) return [el("p", { class: "muted" }, "All designs make the same choices.")];
  const left = wanted.length - sound.length;
  const note = left
    ? [
        el(
          "p",
          { class: "hint" },
          `${count(left, "design")} without a finite value ${left === 1 ? "is" : "are"} in no box.`,
        ),
      ]
    : [];
  return [
    ...places.map((name) => {
      const groups = new Map<string, number[]>();
      for (const design of designs) {
        const chosen = choiceAt(store, configurationOf(model, design), name) || "\u2013 (none)";
        const members = groups.get(chosen);
        if (members) members.push(design);
        else groups.set(chosen, [design]);
      }
      const rows = [...groups]
        .sort(([a], [b]) => (a < b ? -1 : 1))
        .map(([chosen, members]) => {
          const feasible = members.filter((design) => mark[design] === PASS).length;
          const values = (choices.among === "all" ? members : members.filter((design) => mark[design] === PASS))
            .map((design) => column.values[design]!)
            .filter(Number.isFinite);
          return rowOf(chosen, boxOf(values), span, column.text, members.length, feasible);
        });
      const titles = ["Alternative", "Designs", "Feasible", axisLabel(column), "Least", "Median", "Greatest"];
      const head = titles.map((title, index) =>
        el("th", { scope: "col", class: index === 3 ? "drawn" : index ? "numeric" : "" }, title),
      );
      return el(
        "div",
        { class: "scroll" },
        el(
          "table",
          { class: "boxes", "data-place": name },
          el("caption", {}, name),
          el("thead", {}, el("tr", {}, ...head)),
          el("tbody", {}, ...rows),
        ),
      );
    }),
    ...note,
  ];
}

function rowOf(
  name: string,
  box: Box | null,
  span: Box | null,
  text: (value: number) => string,
  designs: number,
  feasible: number,
): HTMLElement {
  const cell = (value: string): HTMLElement => el("td", { class: "numeric" }, value);
  return el(
    "tr",
    {},
    el("th", { scope: "row" }, name),
    cell(group(designs)),
    el("td", { class: `numeric ${feasible ? "pass" : ""}` }, `${group(feasible)} (${percent(feasible, designs)})`),
    el("td", { class: "drawn" }, box && span && drawn(box, span)),
    ...(box
      ? [box.low, box.median, box.high].map((value) => cell(text(value)))
      : [cell("\u2013"), cell("\u2013"), cell("\u2013")]),
  );
}

function drawn(box: Box, span: Box): Element {
  const at = (value: number): number =>
    6 + (WIDE - 12) * (span.high > span.low ? (value - span.low) / (span.high - span.low) : 0.5);
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", `0 0 ${WIDE} ${HIGH}`);
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("aria-hidden", "true");
  const path = (kind: string, d: string): void => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", "path");
    node.setAttribute("class", kind);
    node.setAttribute("d", d);
    svg.append(node);
  };
  const [low, first, median, third, high] = [box.low, box.first, box.median, box.third, box.high].map(at) as [
    number,
    number,
    number,
    number,
    number,
  ];
  const middle = HIGH / 2;
  path(
    "whisker",
    `M${low} ${middle}H${first}M${third} ${middle}H${high}M${low} ${middle - 5}v10M${high} ${middle - 5}v10`,
  );
  path("box", `M${first} 3H${Math.max(third, first + 2)}V${HIGH - 3}H${first}Z`);
  path("median", `M${median} 2V${HIGH - 2}`);
  return svg;
}

/** null without values, which must be finite. */
export function boxOf(values: number[]): Box | null {
  if (!values.length) return null;
  const sorted = Float64Array.from(values).sort();
  const quantile = (share: number): number => {
    const at = share * (sorted.length - 1);
    const [below, above] = [sorted[Math.floor(at)]!, sorted[Math.ceil(at)]!];
    return below + (above - below) * (at - Math.floor(at));
  };
  return {
    low: sorted[0]!,
    first: quantile(0.25),
    median: quantile(0.5),
    third: quantile(0.75),
    high: sorted.at(-1)!,
    count: sorted.length,
  };
}
