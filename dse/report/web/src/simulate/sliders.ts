// A slider for everything that a run may be given: first what the study varies, then every part's parameters.
import { choose, el } from "../dom";
import { number } from "../format";
import { type Setting, type SimulationDocument, shown } from "./document";

/** A setting of a system as the reader moves it. */
export interface Control {
  /** Its place among the system's settings. */
  place: number;
  setting: Setting;
  title: string;
  /** `value` in this unit is `(SI - offset) / factor`. */
  unit: string;
  factor: number;
  offset: number;
  low: number;
  high: number;
  /** Whether the study varies it. */
  isVaried: boolean;
}

/** A bound that is so many times the value away is no end for a slider. */
const FAR = 10;

/** Those that the study varies come first. */
export function controlsOf(document: SimulationDocument, system: number): Control[] {
  const found = document.systems[system]!.settings.map(([at, , value], place): Control => {
    const setting = document.settings[at]!;
    const varied = document.variables.find(({ name }) => name === setting.name);
    if (varied) return { ...varied, place, setting, isVaried: true };
    const { title, unit, factor, offset } = setting;
    const [low, high] = rangeOf(setting, shown(value, setting));
    return { place, setting, title, unit, factor, offset, low, high, isVaried: false };
  });
  return [...found.filter(({ isVaried }) => isVaried), ...found.filter(({ isVaried }) => !isVaried)];
}

function rangeOf(setting: Setting, value: number): [number, number] {
  const { low, high, kind, items } = setting;
  if (kind === "boolean") return [0, 1];
  if (items.length) return [0, items.length - 1];
  const near = (bound: number | null, otherwise: number): number => {
    const end = bound === null ? NaN : shown(bound, setting);
    return Math.abs(end) <= FAR * Math.abs(value) || (value === 0 && Math.abs(end) < Infinity) ? end : otherwise;
  };
  return [near(low, value > 0 ? 0 : value < 0 ? 2 * value : -1), near(high, value > 0 ? 2 * value : value < 0 ? 0 : 1)];
}

export interface Sliders {
  element: HTMLElement;
  /** Shows *values* of the system's settings (SI). */
  show(values: Float64Array): void;
}

/** Calls *moved* with a place and its new value (SI). */
export function createSliders(
  controls: Control[],
  start: Float64Array,
  moved: (place: number, si: number) => void,
): Sliders {
  const rows = controls.map((control) => createRow(control, start[control.place]!, moved));
  const search = el("input", {
    type: "search",
    class: "find",
    placeholder: "Find a parameter",
    "aria-label": "Find a parameter",
  });
  const parts = new Map<string, typeof rows>();
  for (const row of rows.filter(({ control }) => !control.isVaried)) {
    const part = row.control.setting.name.split(".").slice(0, -1).join(".");
    parts.set(part, [...(parts.get(part) ?? []), row]);
  }
  const groups = [...parts].map(([part, those]) => ({
    those,
    box: el("details", { class: "part" }, el("summary", {}, part), ...those.map(({ element }) => element)),
  }));
  search.addEventListener("input", () => {
    const wanted = search.value.trim().toLowerCase();
    for (const { control, element } of rows)
      element.hidden = !`${control.title} ${control.setting.name}`.toLowerCase().includes(wanted);
    for (const { those, box } of groups) {
      box.hidden = those.every(({ element }) => element.hidden);
      box.open = wanted !== "" && !box.hidden;
    }
  });
  const varied = rows.filter(({ control }) => control.isVaried).map(({ element }) => element);
  const element = el("div", { class: "sliders" }, ...varied, search, ...groups.map(({ box }) => box));
  return {
    element,
    show(values) {
      for (const { control, show } of rows) show(values[control.place]!);
    },
  };
}

function createRow(control: Control, start: number, moved: (place: number, si: number) => void) {
  const { setting, title, unit, low, high, place } = control;
  const { kind, items } = setting;
  const labels = kind === "boolean" ? ["no", "yes"] : items;
  const set = (value: number): void => {
    if (!Number.isFinite(value)) return show(now);
    const si = value * control.factor + control.offset;
    moved(place, Math.min(setting.high ?? Infinity, Math.max(setting.low ?? -Infinity, si)));
  };
  let now = start;
  const select = labels.length
    ? choose(
        labels.map((label, value): [string, string] => [String(value), label]),
        String(start),
        (value) => set(Number(value)),
      )
    : null;
  const step = kind === "integer" ? 1 : (high - low) / 200;
  const slider = el("input", {
    type: "range",
    min: low,
    max: high,
    step,
    "aria-label": title,
    input: () => set(Number(slider.value)),
  });
  const entry = el("input", {
    type: "number",
    step: "any",
    "aria-label": `${title}${unit && ` in ${unit}`}`,
    change: () => set(Number(entry.value)),
  });
  const back = el(
    "button",
    {
      type: "button",
      class: "bare",
      title: "Back to where it started",
      "aria-label": `${title} back to where it started`,
      click: () => moved(place, start),
    },
    "\u21ba",
  );
  const controls = select ? [select] : [slider, entry, el("span", { class: "muted unit" }, unit || "\u2013")];
  if (select) select.setAttribute("aria-label", title);
  const name = el("span", { class: "name", title: setting.name }, title);
  const element = el("div", { class: "setting", "data-name": setting.name }, name, ...controls, back);
  const show = (si: number): void => {
    now = si;
    const value = (si - control.offset) / control.factor;
    if (select) select.value = String(value);
    // What the reader types or drags stays as it is.
    if (document.activeElement !== slider || Number(slider.value) !== value) slider.value = String(value);
    if (document.activeElement !== entry) entry.value = String(Number(value.toPrecision(6)));
    slider.setAttribute("aria-valuetext", `${number(value)} ${unit}`.trim());
    element.classList.toggle("moved", si !== start);
    back.disabled = si === start;
  };
  show(start);
  return { control, element, show };
}
