// The prediction profiler: what a formula says of a metric along each factor, from a point that the reader moves.
import { selectRun } from "../../actions";
import type { Chart } from "../../chart";
import { choose, el } from "../../dom";
import { group, number, withUnit } from "../../format";
import type { Part, Profile, Response } from "../../insight";
import { paintChart } from "../../plot/chart";
import type { Store } from "../../store";
import { palette } from "../../theme";
import { createPainted, type Painted } from "../shared/canvas";
import { apartOf, levelAt, levelOf, nearestOf, placeAt, placeText, valueAt } from "../shared/places";
import { planeName } from "../shared/planes";
import { withLevel } from "./choices";
import { whiskers } from "./dependence";
import { predict } from "./formula";
import { chooseProfilePlaces, profilePlaces } from "./selection";

const STEPS = 41;
const MOST_FACTORS = 12;
const POOR = 0.7;

export function createProfiler(store: Store, part: Part, response: Response): HTMLElement {
  const { study } = store;
  const { profile } = response;
  const metric = study.metrics[response.metric]!;
  if (!profile)
    return el(
      "p",
      { class: "hint" },
      `There is no formula for ${metric.title}: ${response.withheld.find((text) => text.startsWith("a formula: "))?.slice(11) ?? "none was made"}.`,
    );
  const value = el("p", { class: "headline-small", id: "prediction", "aria-live": "polite" });
  const nearestText = el("p", { class: "hint", id: "nearest-run" });
  const order = shownFactors(part, response);
  const controls = order.map((factor) =>
    createControl(
      store,
      part,
      profile,
      response,
      factor,
      () => profilePlaces(store, part),
      (place) => chooseProfilePlaces(store, moved(store, part, profilePlaces(store, part), factor, place)),
    ),
  );
  const draw = (): void => {
    const places = profilePlaces(store, part);
    const here = predict(part, profile, places);
    value.replaceChildren(
      `${metric.title} `,
      el("b", {}, withUnit(number(here, 4), metric.unit)),
      ` \u00b1\u202f${withUnit(number(profile.error, 2), metric.unit)}`,
    );
    const near = nearestRun(store, part, places);
    nearestText.replaceChildren(...nearest(store, near, metric));
    const [low, high] = span(store, part, profile, response, places, order);
    for (const { show } of controls) show(low, high);
  };
  const select = el(
    "button",
    {
      type: "button",
      id: "profile-nearest",
      click: () => {
        const places = profilePlaces(store, part);
        const run = nearestRun(store, part, places);
        if (run < 0) return;
        selectRun(store, run);
        chooseProfilePlaces(store, places);
      },
    },
    "Select the nearest run",
  );
  const box = el(
    "div",
    {},
    el("div", { class: "prediction" }, value, select),
    nearestText,
    el("div", { class: "minis profile" }, ...controls.map(({ element }) => element)),
    part.factors.length > order.length &&
      el(
        "p",
        { class: "hint" },
        `${part.factors.length - order.length} factors that ${aliasedOf(part, response).size ? "always change together, or matter less," : "matter less"} stay as in the selected run.`,
      ),
    el(
      "p",
      { class: `hint${profile.explained < POOR ? " poor" : ""}` },
      quality(part, profile, study.variables.length ? planeName(study, part.plane) : ""),
    ),
  );
  store.subscribe((_, changed) => {
    if (changed.has("selected") || changed.has("thresholds") || changed.has("settings")) draw();
  });
  draw();
  return box;
}

function quality(part: Part, { error, explained, runs, power }: Profile, plane: string): string {
  const poor = explained < POOR ? "This is a poor formula: do not rely on it. " : "";
  const held = part.plane.length ? ` All else than ${plane} is held at its nominal value.` : "";
  const together = part.factors.some(({ variable }) => variable < 0)
    ? " Choices that only go with another one change along with it."
    : "";
  return `${poor}The curves are a formula (radial functions, power ${power}), not simulations. Of ${group(runs)} runs that were left out in turn it predicts ${Math.max(0, Math.round(1000 * explained) / 10)}\u202f% of the variance, with a root mean square error of ${number(error, 2)}: the band.${held}${together}`;
}

/** Factors that always change together have no effects of their own, and a formula would invent the runs between. */
function aliasedOf(part: Part, { effects, withheld }: Response): Set<number> {
  if (!withheld.some((text) => text.startsWith("effects of single factors"))) return new Set();
  const separate = new Set(effects.map(({ factor }) => factor));
  return new Set([...part.factors.keys()].filter((factor) => !separate.has(factor)));
}

function shownFactors(part: Part, response: Response): number[] {
  const { bars } = response;
  const aliased = aliasedOf(part, response);
  const share = (factor: number): number => bars.find((bar) => bar.factor === factor)?.share[0] ?? 0;
  const strongest = part.factors
    .map((_, index) => index)
    .filter((factor) => !aliased.has(factor))
    .sort((a, b) => share(b) - share(a))
    .slice(0, MOST_FACTORS);
  return part.factors.length > MOST_FACTORS ? strongest : strongest.sort((a, b) => a - b);
}

function curve(
  store: Store,
  part: Part,
  profile: Profile,
  factor: number,
  places: number[],
): { at: number[]; values: number[] } {
  const axis = part.factors[factor]!;
  const apart = apartOf(store.study, axis);
  const at = apart.length
    ? apart.map((value) => placeAt(axis, value))
    : axis.variable < 0
      ? axis.levels.map((_, level) => (level + 0.5) / axis.levels.length)
      : Array.from({ length: STEPS }, (_, step) => step / (STEPS - 1));
  return { at, values: at.map((place) => predict(part, profile, moved(store, part, places, factor, place))) };
}

function moved({ study }: Store, part: Part, places: number[], factor: number, place: number): number[] {
  const axis = part.factors[factor]!;
  return axis.variable < 0
    ? withLevel(study, part, places, factor, levelAt(axis, place))
    : places.map((each, index) => (index === factor ? place : each));
}

function span(
  store: Store,
  part: Part,
  profile: Profile,
  { metric }: Response,
  places: number[],
  order: number[],
): [number, number] {
  const { study, state } = store;
  const all = order.flatMap((factor) => curve(store, part, profile, factor, places).values);
  for (const [index, requirement] of study.requirements.entries()) {
    const { atMost, atLeast } = state.thresholds[index]!;
    if (requirement.metric === metric) all.push(...[atMost, atLeast].filter((bound) => bound !== null));
  }
  const [low, high] = [Math.min(...all) - profile.error, Math.max(...all) + profile.error];
  const rim = 0.05 * (high - low) || 1;
  return [low - rim, high + rim];
}

interface Control {
  element: HTMLElement;
  show: (low: number, high: number) => void;
}

function createControl(
  store: Store,
  part: Part,
  profile: Profile,
  response: Response,
  factor: number,
  places: () => number[],
  move: (place: number) => void,
): Control {
  const axis = part.factors[factor]!;
  const metric = store.study.metrics[response.metric]!;
  const apart = apartOf(store.study, axis);
  const isChoice = axis.variable < 0 || apart.length > 0;
  const names = apart.length ? apart.map((value) => withUnit(number(value), axis.unit)) : axis.labels;
  const indexAt = (place: number): number => (apart.length ? nearestOf(axis, apart, place) : levelAt(axis, place));
  let range: [number, number] = [0, 1];
  const painted: Painted = createPainted(
    store,
    "mini",
    `${metric.title} along ${axis.label}, as a formula predicts it`,
    (sheet) => paintChart(sheet, chartOf(), palette()),
  );
  const chartOf = (): Chart => {
    const { at, values } = curve(store, part, profile, factor, places());
    const x = Float64Array.from(at, (place, index) => (isChoice ? index : valueAt(axis, place)));
    const y = Float64Array.from(values);
    const [below, above] = [y.map((each) => each - profile.error), y.map((each) => each + profile.error)];
    const here = places()[factor]!;
    return {
      name: "profile",
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
      y: { title: metric.title, unit: metric.unit, log: false, low: range[0], high: range[1], names: [] },
      drawn: [
        ...(isChoice ? whiskers(x, below, above) : [{ kind: "band" as const, label: "", x, low: below, high: above }]),
        isChoice
          ? { kind: "points", label: "", verdict: null, x, y, runs: new Int32Array(x.length) }
          : { kind: "line", label: "", x, y },
        { kind: "rule", label: "", axis: "x", value: isChoice ? indexAt(here) : valueAt(axis, here) },
        ...bounds(store, response),
      ],
    };
  };
  const text = el("output", {});
  const label = `${axis.label}, where the formula is evaluated`;
  const slider = isChoice
    ? null
    : el("input", {
        type: "range",
        min: 0,
        max: 1,
        step: 0.005,
        "aria-label": label,
        input: () => move(Number((slider as HTMLInputElement).value)),
      });
  const select = isChoice
    ? choose(
        names.map((level, index): [string, string] => [String(index), level]),
        "0",
        (value) =>
          move(apart.length ? placeAt(axis, apart[Number(value)]!) : (Number(value) + 0.5) / axis.levels.length),
      )
    : null;
  select?.setAttribute("aria-label", label);
  if (!isChoice) dragged(painted, move);
  return {
    element: el(
      "div",
      { class: "profile-cell" },
      painted.element,
      el("div", { class: "profile-control" }, slider ?? select, slider && text),
    ),
    show(low, high) {
      range = [low, high];
      const place = places()[factor]!;
      if (slider) {
        slider.value = String(place);
        text.textContent = placeText(axis, place);
        slider.setAttribute("aria-valuetext", placeText(axis, place));
      }
      if (select) select.value = String(indexAt(place));
      painted.repaint();
    },
  };
}

// The line on the curve can be taken hold of; the plot leaves 66 and 16 pixels for its axes.
function dragged({ element }: Painted, move: (place: number) => void): void {
  const at = (event: PointerEvent): void => {
    const { left, width } = element.getBoundingClientRect();
    move(Math.min(1, Math.max(0, (event.clientX - left - 66) / Math.max(1, width - 82))));
  };
  element.classList.add("draggable");
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    at(event);
  });
  element.addEventListener("pointermove", (event) => {
    if (element.hasPointerCapture(event.pointerId)) at(event);
  });
}

function bounds({ study, state }: Store, { metric }: Response): Chart["drawn"] {
  return study.requirements.flatMap((requirement, index) => {
    const { atMost, atLeast, off } = state.thresholds[index]!;
    if (requirement.metric !== metric || off) return [];
    return [atMost, atLeast]
      .filter((bound) => bound !== null)
      .map((value) => ({ kind: "rule" as const, label: "", axis: "y" as const, value }));
  });
}

function nearestRun({ study }: Store, part: Part, places: number[]): number {
  const wanted = part.factors.map((factor, index) =>
    factor.variable < 0 ? factor.levels[levelAt(factor, places[index]!)]! : valueAt(factor, places[index]!),
  );
  const held = part.plane.length
    ? study.variables.map((_, index) => index).filter((index) => !part.plane.includes(index))
    : [];
  let [best, least] = [-1, Infinity];
  for (let run = 0; run < study.size; run++) {
    let square = 0;
    for (const [index, factor] of part.factors.entries()) {
      if (factor.variable < 0) {
        if (levelOf(study, factor, run) !== wanted[index]) square += 1;
        continue;
      }
      const { values, low, high } = study.variables[factor.variable]!;
      square += ((values[run]! - (wanted[index] as number)) / (high - low)) ** 2;
    }
    for (const index of held) {
      const { values, low, high, nominal } = study.variables[index]!;
      square += ((values[run]! - nominal) / (high - low)) ** 2;
    }
    if (square < least) [least, best] = [square, run];
  }
  return best;
}

function nearest({ study }: Store, run: number, metric: Store["study"]["metrics"][number]): (Node | string)[] {
  if (run < 0) return ["There is no run."];
  const there = metric.values[run]!;
  return [
    `The nearest run, ${study.number[run]}, was simulated: ${Number.isNaN(there) ? "undefined there" : withUnit(metric.text(there), metric.unit)}.`,
  ];
}
