// What the reader has chosen, in the fragment of the page's address: a link opens the page as it was left.
// Whatever stands there may be wrong or made up; what does not fit the study is left out.
import { columnOf } from "./columns";
import { levels } from "./plane/plane";
import { wholeOf } from "./plot/zoom";
import { MOST_PINS, type State, type Store, type Zoom } from "./store";
import type { Study } from "./study";
import { VIEWS } from "./views/views";

// An address with more than these was not written here.
const MOST_LISTED = 50;
// A browser slows pages down that change their address too often.
const PAUSE = 300;

/** Keeps the address up with the store, and the store with an address that is typed in; *start* is the page without any. */
export function followAddress(store: Store, start: State): void {
  let timer = 0;
  const write = (): void => {
    const fragment = fragmentOf(store.study, store.state, start);
    if (fragment !== location.hash.slice(1))
      history.replaceState(history.state, "", fragment ? `#${fragment}` : location.pathname + location.search);
  };
  store.subscribe((_, changed) => {
    if (changed.size === 1 && changed.has("hovered")) return;
    clearTimeout(timer);
    timer = window.setTimeout(write, PAUSE);
  });
  window.addEventListener("hashchange", () =>
    store.set({ ...start, theme: store.state.theme, ...readFragment(store.study, location.hash.slice(1), start) }),
  );
}

/** The differences of *state* from *start*. */
export function fragmentOf(study: Study, state: State, start: State): string {
  const parts: [string, string][] = [];
  const add = (key: string, now: string, then: string): void => {
    if (now !== then) parts.push([key, now]);
  };
  const pairs = (numbers: readonly number[]): string => numbers.join(":");
  add("view", state.view, start.view);
  add(
    "configuration",
    study.configurations[state.configuration]?.id ?? "",
    study.configurations[start.configuration]?.id ?? "",
  );
  add("plane", `${state.x},${state.y}`, `${start.x},${start.y}`);
  add(
    "fixed",
    state.fixed.flatMap((value, index) => (Object.is(value, start.fixed[index]) ? [] : [`${index}:${value}`])).join(),
    "",
  );
  add("zoom", state.zoom ? pairs([...state.zoom.x, ...state.zoom.y]) : "", "");
  add("fill", String(state.fill), String(start.fill));
  add("bounds", changedBounds(state, start), "");
  add("brushes", state.brushes.map(({ column, low, high }) => `${column}:${low}:${high}`).join(), "");
  add("pins", state.pins.map((pin) => study.number[pin]).join(), "");
  add("run", String(study.number[state.selected] ?? ""), String(study.number[start.selected] ?? ""));
  add("filter", String(state.filter), String(start.filter));
  add(
    "sort",
    `${state.sort.column}:${state.sort.descending ? "down" : "up"}`,
    `${start.sort.column}:${start.sort.descending ? "down" : "up"}`,
  );
  for (const [key, value] of Object.entries(state.settings)) add(key, value, "");
  return parts
    .map(
      ([key, value]) =>
        `${encodeURIComponent(key)}=${encodeURIComponent(value).replace(/%3A/g, ":").replace(/%2C/g, ",")}`,
    )
    .join("&");
}

/** What *fragment* says that fits the study. */
export function readFragment(study: Study, fragment: string, start: State): Partial<State> {
  const given = new URLSearchParams(fragment);
  const patch: Partial<State> = {};
  const runOf = (text: string): number => (/^\d{1,9}$/.test(text) ? study.number.indexOf(Number(text)) : -1);
  const view = VIEWS.find(({ name, suits }) => name === given.get("view") && suits(study));
  if (view) patch.view = view.name;
  const configuration = study.configurations.findIndex(({ id }) => id === given.get("configuration"));
  if (configuration >= 0) patch.configuration = configuration;
  const [x, y] = list(given, "plane").map((text) => position(text, study.variables.length));
  if (x !== undefined && y !== undefined && x >= 0 && y >= 0 && x !== y) Object.assign(patch, { x, y });
  if (given.has("fixed")) patch.fixed = readFixed(study, list(given, "fixed"), start.fixed);
  if (given.has("zoom")) patch.zoom = readZoom(study, given.get("zoom")!, patch.x ?? start.x, patch.y ?? start.y);
  const fill = position(given.get("fill") ?? "", study.metrics.length);
  if (fill >= 0) patch.fill = fill;
  if (given.has("bounds")) patch.thresholds = readBounds(study, list(given, "bounds"), start.thresholds);
  if (given.has("brushes")) patch.brushes = readBrushes(study, list(given, "brushes"));
  const pins = list(given, "pins").slice(0, MOST_LISTED).map(runOf);
  if (pins.length) patch.pins = [...new Set(pins)].filter((run) => run >= 0).slice(0, MOST_PINS);
  const selected = runOf(given.get("run") ?? "");
  if (selected >= 0) patch.selected = selected;
  const filter = (["all", 0, 1, 2, 3] as const).find((each) => String(each) === given.get("filter"));
  if (filter !== undefined) patch.filter = filter;
  const [column, direction] = (given.get("sort") ?? "").split(":");
  if (column && direction && (column === "run" || column === "verdict" || columnOf(study, column)))
    patch.sort = { column, descending: direction === "down" };
  const settings = [...given].filter(([key, value]) => key.includes(".") && value);
  if (settings.length) patch.settings = Object.fromEntries(settings);
  return patch;
}

function changedBounds(state: State, start: State): string {
  return state.thresholds
    .flatMap(({ atMost, atLeast, off }, index) => {
      const then = start.thresholds[index]!;
      if (atMost === then.atMost && atLeast === then.atLeast && !off) return [];
      return [[index, atLeast ?? "", atMost ?? "", ...(off ? ["off"] : [])].join(":")];
    })
    .join();
}

function readBounds(study: Study, entries: string[], then: State["thresholds"]): State["thresholds"] {
  const thresholds = then.slice();
  for (const entry of entries) {
    const [text, low, high, off] = entry.split(":");
    const index = position(text ?? "", study.requirements.length);
    if (index < 0) continue;
    const old = thresholds[index]!;
    // A bound that the study does not have has no row to be moved in.
    const bound = (had: number | null, now: string | undefined): number | null =>
      had === null ? null : (finite(now) ?? had);
    thresholds[index] = {
      atMost: bound(old.atMost, high),
      atLeast: bound(old.atLeast, low),
      ...(off === "off" ? { off: true } : {}),
    };
  }
  return thresholds;
}

function readBrushes(study: Study, entries: string[]): State["brushes"] {
  const brushes = new Map<string, State["brushes"][number]>();
  for (const entry of entries) {
    const [column, first, last] = entry.split(":");
    const [low, high] = [finite(first), finite(last)];
    if (column && columnOf(study, column) && low !== null && high !== null && low <= high)
      brushes.set(column, { column, low, high });
  }
  return [...brushes.values()];
}

function readFixed(study: Study, entries: string[], then: number[]): number[] {
  const fixed = then.slice();
  for (const entry of entries) {
    const [text, given] = entry.split(":");
    const index = position(text ?? "", fixed.length);
    const value = finite(given);
    if (index < 0 || value === null) continue;
    const { low, high, role } = study.variables[index]!;
    fixed[index] =
      study.sampler === "scattered" && role !== "condition"
        ? Math.min(high, Math.max(low, value))
        : closest(levels(study, index), value);
  }
  return fixed;
}

function readZoom(study: Study, text: string, x: number, y: number): Zoom | null {
  const [x0, x1, y0, y1] = text.split(":").map(finite);
  if (!study.variables[x] || !study.variables[y]) return null;
  const whole = wholeOf(study, { x, y });
  const fits = (
    low: number | null | undefined,
    high: number | null | undefined,
    [least, most]: readonly [number, number],
  ): boolean => typeof low === "number" && typeof high === "number" && low < high && low >= least && high <= most;
  return fits(x0, x1, whole.x) && fits(y0, y1, whole.y) ? { x: [x0!, x1!], y: [y0!, y1!] } : null;
}

function closest(values: number[], wanted: number): number {
  return values.reduce(
    (best, value) => (Math.abs(value - wanted) < Math.abs(best - wanted) ? value : best),
    values[0] ?? wanted,
  );
}

function list(given: URLSearchParams, key: string): string[] {
  return (given.get(key) ?? "").split(",").filter(Boolean);
}

function finite(text: string | undefined): number | null {
  const value = Number(text);
  return text && Number.isFinite(value) ? value : null;
}

function position(text: string, size: number): number {
  const value = Number(text);
  return /^\d{1,9}$/.test(text) && value < size ? value : -1;
}
