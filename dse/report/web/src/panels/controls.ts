// Which plane is shown: slices, axes, configuration, colour, and the place of the plane.
import { planeToSelected, selectConfiguration } from "../actions";
import { choose, el, field } from "../dom";
import { number, shortened, withUnit } from "../format";
import { groupingOf } from "../grouping";
import { levels, movable } from "../plane/plane";
import { conditionsOf } from "../points";
import type { State, Store } from "../store";
import { axisLabel, type Configuration } from "../study";

const SHOWN: (keyof State)[] = ["configuration", "x", "y", "fixed", "fill"];

export function createControls(store: Store): HTMLElement {
  const box = el("div", { class: "controls" });
  const draw = (): void => {
    const focused = (document.activeElement as HTMLElement | null)?.id;
    box.replaceChildren(...parts(store));
    if (focused) document.getElementById(focused)?.focus();
  };
  draw();
  store.subscribe((_, changed) => {
    if (!SHOWN.some((key) => changed.has(key))) return;
    // A slider that is being dragged must stay the same element.
    if (changed.has("fixed") && document.activeElement?.classList.contains("fixing")) updateReadings(store, box);
    else draw();
  });
  return box;
}

function parts(store: Store): HTMLElement[] {
  const { study, state } = store;
  const rows: HTMLElement[] = [];
  if (study.slices.length > 1) rows.push(slices(store));
  const names = study.variables.map((variable, index) => [String(index), axisLabel(variable)] as [string, string]);
  const row = el("div", { class: "row" });
  const axis = (key: "x" | "y"): HTMLElement => {
    const other = key === "x" ? "y" : "x";
    const select = choose(names, String(state[key]), (value) => {
      const chosen = Number(value);
      store.set(chosen === state[other] ? { [key]: chosen, [other]: state[key] } : { [key]: chosen });
    });
    select.id = `axis-${key}`;
    return field(key === "x" ? "Horizontal" : "Vertical", select);
  };
  row.append(axis("x"), axis("y"));
  if (study.configurations.length > 1) {
    const told = differences(study.configurations);
    const options = study.configurations.map(
      ({ id }, index) => [String(index), shortened(`${id} ${told[index]}`, 90)] as [string, string],
    );
    const select = choose(options, String(state.configuration), (value) => selectConfiguration(store, Number(value)));
    select.id = "configuration";
    row.append(field("Configuration", select));
  }
  const fills: [string, string][] = [["-1", "region that meets all requirements"]];
  study.metrics.forEach((metric, index) => fills.push([String(index), axisLabel(metric)]));
  const fill = choose(fills, String(state.fill), (value) => store.set({ fill: Number(value) }));
  fill.id = "fill";
  row.append(field("Colour", fill));
  rows.push(row);
  const free = conditionsOf(study).filter((index) => index !== state.x && index !== state.y);
  for (const index of free) row.append(conditionField(store, index));
  const rest = movable(study, state.x, state.y).filter((index) => !free.includes(index));
  if (rest.length) {
    row.append(
      el(
        "button",
        {
          id: "through-selected",
          type: "button",
          title: "Move the plane through the selected run",
          click: () => planeToSelected(store),
        },
        "Through run",
      ),
    );
    rows.push(sliders(store, rest));
  }
  return rows;
}

// What each was chosen to be, where the configurations differ.
function differences(configurations: Configuration[]): string[] {
  const places = [...new Set(configurations.flatMap(({ choices }) => choices.map(([place]) => place)))];
  const chosen = configurations.map(({ choices }) => new Map(choices));
  const telling = places.filter((place) => chosen.some((choices) => choices.get(place) !== chosen[0]!.get(place)));
  return chosen.map((choices) => telling.flatMap((place) => choices.get(place) ?? []).join(", "));
}

function slices(store: Store): HTMLElement {
  const { study, state } = store;
  const bar = el("div", { class: "tabs", role: "group", "aria-label": "Slices of the study" });
  study.slices.forEach(([x, y], index) => {
    const pressed = state.x === x && state.y === y;
    bar.append(
      el(
        "button",
        {
          id: `slice-${index}`,
          type: "button",
          "aria-pressed": String(pressed),
          click: () => store.set({ x: x!, y: y! }),
        },
        `${study.variables[x!]!.title} \u00d7 ${study.variables[y!]!.title}`,
      ),
    );
  });
  return bar;
}

function sliders(store: Store, rest: number[]): HTMLElement {
  const { study, state } = store;
  const box = el("div", { class: "fixed" });
  for (const index of rest) {
    const { title, low, high, unit, text, labels, apart } = study.variables[index]!;
    if (labels.length || apart.length) {
      box.append(el("span", {}, title), choice(store, index));
      continue;
    }
    const places = study.sampler === "scattered" ? null : levels(study, index);
    const slider = el("input", {
      id: `fixed-${index}`,
      class: "fixing",
      type: "range",
      min: places ? 0 : low,
      max: places ? places.length - 1 : high,
      step: places ? 1 : (high - low) / 100,
      value: places ? places.indexOf(state.fixed[index]!) : state.fixed[index]!,
      "aria-label": `${title} of the plane shown`,
      input: () => {
        const fixed = store.state.fixed.slice();
        fixed[index] = places ? places[Number(slider.value)]! : Number(slider.value);
        slider.setAttribute("aria-valuetext", withUnit(number(fixed[index]!), unit));
        store.set({ fixed });
      },
    });
    slider.setAttribute("aria-valuetext", withUnit(text(state.fixed[index]!), unit));
    box.append(
      el("span", {}, title),
      slider,
      el("output", { id: `reading-${index}`, for: `fixed-${index}` }, withUnit(text(state.fixed[index]!), unit)),
    );
  }
  return box;
}

/** Values between which there is nothing are chosen, not slid through. */
function choice(store: Store, index: number): HTMLElement {
  const { title, unit, text } = store.study.variables[index]!;
  const options = levels(store.study, index).map((value): [string, string] => [
    String(value),
    withUnit(text(value), unit),
  ]);
  const select = choose(options, String(store.state.fixed[index]), (value) => {
    const fixed = store.state.fixed.slice();
    fixed[index] = Number(value);
    store.set({ fixed });
  });
  select.id = `fixed-${index}`;
  select.setAttribute("aria-label", `${title} of the plane shown`);
  return select;
}

/** A condition is at the worst of its values unless one is asked for. */
function conditionField(store: Store, index: number): HTMLElement {
  const { study, state } = store;
  const { title, unit, text } = study.variables[index]!;
  const options = levels(study, index).map((value): [string, string] => [String(value), withUnit(text(value), unit)]);
  const select = choose(
    [["", "worst of all"], ...options],
    Number.isNaN(state.fixed[index]!) ? "" : String(state.fixed[index]),
    (value) => {
      const fixed = store.state.fixed.slice();
      fixed[index] = value === "" ? NaN : Number(value);
      const designs = groupingOf(study).of;
      store.set({ fixed });
      // The selected design stays selected, at the condition that is let through.
      const points = store.points();
      const { selected } = store.state;
      const same =
        selected < 0 || points.first(selected) >= 0
          ? -1
          : points.runs.findIndex((run) => designs[run] === designs[selected]);
      if (same >= 0) store.set({ selected: points.deciding(points.runs[same]!) });
    },
  );
  select.id = `condition-${index}`;
  return field(`Condition: ${title}`, select);
}

function updateReadings(store: Store, box: HTMLElement): void {
  store.study.variables.forEach(({ unit, text }, index) => {
    const reading = box.querySelector(`#reading-${index}`);
    if (reading && !Number.isNaN(store.state.fixed[index]!))
      reading.textContent = withUnit(text(store.state.fixed[index]!), unit);
  });
}
