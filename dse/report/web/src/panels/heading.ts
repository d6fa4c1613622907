// A range in the heading of a table's column: dragging across it, or its two handles, filters every view.
import { rebrushed } from "../brush";
import { columnOf } from "../columns";
import { choose, el } from "../dom";
import { withUnit } from "../format";
import { type Axis, axisOf } from "../plot/parallel";
import type { Store } from "../store";

const STEP = 0.02;
const REACH = 8;
const STILL = 3;
const STEPS: Record<string, number> = {
  ArrowLeft: -STEP,
  ArrowDown: -STEP,
  ArrowRight: STEP,
  ArrowUp: STEP,
  PageDown: -5 * STEP,
  PageUp: 5 * STEP,
  Home: -1,
  End: 1,
};

export interface Heading {
  element: HTMLElement;
  /** Shows the range that is brushed. */
  show: () => void;
}

/** For the column with *key*; null where there is nothing to choose from. */
export function createHeading(store: Store, key: string): Heading | null {
  const axis = columnOf(store.study, key) && axisOf(store.study, key);
  if (!axis || !(axis.most > axis.least)) return null;
  const { title, unit, text } = columnOf(store.study, key)!;
  if (axis.apart.length) return createChoice(store, key, axis, title);
  const band = el("span", { class: "band" });
  const handles = (["from", "to"] as const).map((end) =>
    el("span", {
      class: "handle",
      role: "slider",
      tabindex: 0,
      "aria-label": `${title}: ${end}`,
      "aria-valuemin": 0,
      "aria-valuemax": 100,
    }),
  ) as [HTMLElement, HTMLElement];
  const element = el(
    "span",
    { class: "heading-range", title: `Drag a range of ${title} to filter every view; a click clears it` },
    band,
    ...handles,
  );
  const brush = () => store.state.brushes.find(({ column }) => column === key);
  const range = (): [number, number] => {
    const { low, high } = brush() ?? { low: axis.least, high: axis.most };
    return [shareOf(axis, low), shareOf(axis, high)];
  };
  const set = (a: number, b: number): void => {
    const [from, to] = [Math.max(0, Math.min(a, b)), Math.min(1, Math.max(a, b))];
    const whole = from <= 0 && to >= 1;
    store.set({
      brushes: rebrushed(store.state.brushes, key, whole ? null : [valueAt(axis, from), valueAt(axis, to)]),
    });
  };
  const show = (): void => {
    const ends = range();
    const { low, high } = brush() ?? { low: axis.least, high: axis.most };
    element.classList.toggle("brushed", brush() !== undefined);
    band.style.left = `${100 * ends[0]}%`;
    band.style.width = `${100 * (ends[1] - ends[0])}%`;
    handles.forEach((handle, index) => {
      handle.style.left = `${100 * ends[index]!}%`;
      handle.setAttribute("aria-valuenow", String(Math.round(100 * ends[index]!)));
      handle.setAttribute("aria-valuetext", withUnit(text(index ? high : low), unit));
    });
  };
  handles.forEach((handle, index) =>
    handle.addEventListener("keydown", (event) => {
      const step = STEPS[event.key];
      const clears = ["Escape", "Delete", "Backspace"].includes(event.key) && brush();
      if (event.altKey || event.ctrlKey || event.metaKey || (step === undefined && !clears)) return;
      event.preventDefault();
      // The table would move its selection.
      event.stopPropagation();
      if (step === undefined) return set(0, 1);
      const [from, to] = range();
      if (index) set(from, Math.max(from, to + step));
      else set(Math.min(to, from + step), to);
    }),
  );
  dragged(element, range, set);
  show();
  return { element, show };
}

/** Of values that are names, or between which nothing is known, one is chosen. */
function createChoice(store: Store, key: string, { apart, texts }: Axis, title: string): Heading {
  const options = apart.map((value, index): [string, string] => [String(value), texts[index]!]);
  const select = choose([["", "all"], ...options], "", (value) =>
    store.set({
      brushes: rebrushed(store.state.brushes, key, value === "" ? null : [Number(value), Number(value)]),
    }),
  );
  select.className = "heading-choice";
  select.setAttribute("aria-label", `Only one value of ${title}`);
  const show = (): void => {
    const brush = store.state.brushes.find(({ column }) => column === key);
    const within = brush ? apart.filter((value) => value >= brush.low && value <= brush.high) : [];
    select.value = within.length === 1 ? String(within[0]) : "";
  };
  show();
  return { element: select, show };
}

function dragged(element: HTMLElement, range: () => [number, number], set: (a: number, b: number) => void): void {
  let fixed: number | null = null;
  let moved = false;
  let start = 0;
  const at = (event: PointerEvent): number => {
    const { left, width } = element.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - left) / Math.max(1, width)));
  };
  element.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.preventDefault();
    const reach = REACH / Math.max(1, element.clientWidth);
    const [from, to] = range();
    // A handle that is taken hold of leaves the other one where it is.
    const isNear = [Math.abs(at(event) - from) < reach, Math.abs(at(event) - to) < reach];
    fixed = isNear[1] ? from : isNear[0] ? to : at(event);
    moved = isNear[0]! || isNear[1]!;
    start = event.clientX;
    element.setPointerCapture(event.pointerId);
  });
  element.addEventListener("pointermove", (event) => {
    if (fixed === null || (!moved && Math.abs(event.clientX - start) <= STILL)) return;
    moved = true;
    if (event.clientX !== start) set(fixed, at(event));
  });
  element.addEventListener("pointerup", () => {
    if (fixed !== null && !moved) set(0, 1);
    fixed = null;
  });
  element.addEventListener("pointercancel", () => (fixed = null));
}

function shareOf({ low, high }: Axis, value: number): number {
  return Math.min(1, Math.max(0, (value - low) / (high - low)));
}

// The ends stand for the last values, though these may lie beyond what the axis shows.
function valueAt({ low, high, least, most }: Axis, share: number): number {
  return share <= 0 ? least : share >= 1 ? most : low + share * (high - low);
}
