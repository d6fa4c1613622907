// What a metric depends on: shares of its variance (shares.ts), and its means along each factor.
import type { Chart } from "../../chart";
import { el } from "../../dom";
import { number, withUnit } from "../../format";
import type { Part, Response } from "../../insight";
import { paintChart } from "../../plot/chart";
import type { Store } from "../../store";
import { palette } from "../../theme";
import { createPainted } from "../shared/canvas";
import { apartOf, nearestOf, valueAt } from "../shared/places";
import { createShares } from "./shares";

const MOST_FACTORS = 12;

export function createDependence(store: Store, part: Part, response: Response): HTMLElement {
  const shares = createShares(part, response);
  const order = shares.order;
  const effects = [...response.effects].sort((a, b) => place(order, a.factor) - place(order, b.factor));
  const hidden = Math.max(0, effects.length - MOST_FACTORS);
  return el(
    "div",
    {},
    ...response.withheld.map((text) => el("p", { class: "hint withheld" }, `Withheld: ${text}.`)),
    ...shares.elements,
    effects.length > 0 && el("h3", { class: "minor" }, "Mean along each, with its 95 % interval"),
    el(
      "div",
      { class: "minis" },
      ...effects.slice(0, MOST_FACTORS).map((effect) => mini(store, part, response, effect, ends(effects))),
    ),
    hidden > 0 && el("p", { class: "hint" }, `${hidden} factors that matter less are not drawn.`),
  );
}

function place(order: number[], factor: number): number {
  const found = order.indexOf(factor);
  return found < 0 ? order.length : found;
}

function ends(effects: Response["effects"]): [number, number] {
  const all = effects.flatMap(({ means }) => means.flat()).filter((value): value is number => value !== null);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const rim = 0.05 * (high - low) || 1;
  return [low - rim, high + rim];
}

function mini(
  store: Store,
  part: Part,
  response: Response,
  { factor, places, means }: Response["effects"][number],
  [low, high]: [number, number],
): HTMLElement {
  const axis = part.factors[factor]!;
  const metric = store.study.metrics[response.metric]!;
  const apart = apartOf(store.study, axis);
  const names = apart.length ? apart.map((value) => withUnit(number(value), axis.unit)) : axis.labels;
  const isChoice = axis.variable < 0 || apart.length > 0;
  const placed = (each: number): number =>
    apart.length ? nearestOf(axis, apart, each) : isChoice ? each * axis.levels.length - 0.5 : valueAt(axis, each);
  const at = Float64Array.from(places, placed);
  const column = (index: number): Float64Array => Float64Array.from(means, (mean) => mean[index] ?? NaN);
  const chart: Chart = {
    name: "effect",
    title: axis.label,
    note: "",
    x: {
      title: axis.label,
      unit: axis.unit,
      log: false,
      low: isChoice ? -0.5 : axis.values[0]!,
      high: isChoice ? names.length - 0.5 : axis.values.at(-1)!,
      names: isChoice ? names : [],
    },
    y: { title: metric.title, unit: metric.unit, log: false, low, high, names: [] },
    drawn: [
      ...(isChoice
        ? whiskers(at, column(1), column(2))
        : [{ kind: "band" as const, label: "", x: at, low: column(1), high: column(2) }]),
      isChoice
        ? { kind: "points", label: "", verdict: null, x: at, y: column(0), runs: new Int32Array(at.length) }
        : { kind: "line", label: "", x: at, y: column(0) },
    ],
  };
  const values = means.map((mean, index) => `${mean[0]} at ${isChoice ? names[at[index]!] : at[index]}`).join(", ");
  return createPainted(store, "mini", `Mean of ${metric.title} along ${axis.label}: ${values}`, (sheet) =>
    paintChart(sheet, chart, palette()),
  ).element;
}

/** Levels have no order: nothing is drawn between them. */
export function whiskers(at: Float64Array, low: Float64Array, high: Float64Array): Chart["drawn"] {
  const broken = (values: Float64Array, half = 0): Float64Array =>
    Float64Array.from([...values].flatMap((value) => [value - half, value + half, NaN]));
  return [{ kind: "band", label: "", x: broken(at, 0.12), low: broken(low), high: broken(high) }];
}
