// Pointing, clicking, dragging, the wheel and keys on the constraint plot.
import { selectRun, togglePin } from "../actions";
import { rebrushed } from "../brush";
import { shownRuns } from "../counts";
import { el } from "../dom";
import { isKept } from "../panels/waveforms";
import type { Store } from "../store";
import type { Frame } from "./frame";
import type { Plot } from "./plot";
import { placeOf } from "./points";
import { moveTip } from "./tip";
import { movedBy, wholeOf, zoomedBy } from "./zoom";

const REACH = 18;
const CLICK_REACH = 3 * REACH;
// A hand that clicks moves a little.
const STILL = 4;
const ON_RUN = 5;
const STEP = 1.5;
const ARROWS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

type Place = [number, number];

interface Drag {
  from: Place;
  last: Place;
  kind: "pan" | "box" | "x" | "y";
  moved: boolean;
}

/** Makes the plot answer; the tools are buttons for what the mouse does otherwise. */
export function attachInteraction(store: Store, plot: Plot): HTMLElement[] {
  const tip = el("div", { class: "tip", "aria-hidden": "true", hidden: true });
  const box = el("div", { class: "rubber", "aria-hidden": "true", hidden: true });
  const { surface } = plot;
  surface.append(box, tip);
  const brush = el(
    "button",
    {
      id: "brush",
      type: "button",
      "aria-pressed": "false",
      title: "Dragging brushes a rectangle (also: drag with Shift, or along an axis)",
      click: () => setBrushing(brush.getAttribute("aria-pressed") !== "true"),
    },
    "Brush",
  );
  const setBrushing = (on: boolean): void => brush.setAttribute("aria-pressed", String(on));
  let drag: Drag | null = null;

  const at = (event: MouseEvent): Place => {
    const { left, top } = surface.getBoundingClientRect();
    return [event.clientX - left - surface.clientLeft, event.clientY - top - surface.clientTop];
  };
  const point = (run: number): void => {
    store.set({ hovered: run });
    moveTip(tip, store, plot, run);
  };
  const zoom = (factor: number, place: Place): void => {
    const frame = plot.frame();
    if (!frame) return;
    const whole = wholeOf(store.study, plot.plane());
    store.set({
      zoom: zoomedBy(whole, store.state.zoom ?? whole, factor, [frame.x.invert(place[0]), frame.y.invert(place[1])]),
    });
  };
  const move = (dx: number, dy: number): void => {
    const whole = wholeOf(store.study, plot.plane());
    if (store.state.zoom) store.set({ zoom: movedBy(whole, store.state.zoom, dx, dy) });
  };
  const centre = (): Place => {
    const { left, right, top, bottom } = plot.frame()!;
    return [(left + right) / 2, (top + bottom) / 2];
  };

  surface.addEventListener("pointerdown", (event) => {
    const frame = plot.frame();
    const brushing = event.shiftKey || brush.getAttribute("aria-pressed") === "true";
    // A finger that drags scrolls the page, unless it was asked to brush.
    if (!frame || event.button !== 0 || (event.pointerType === "touch" && !brushing)) return;
    const from = at(event);
    const kind = from[1] > frame.bottom ? "x" : from[0] < frame.left ? "y" : brushing ? "box" : "pan";
    drag = { from, last: from, kind, moved: false };
    surface.setPointerCapture(event.pointerId);
  });
  surface.addEventListener("pointermove", (event) => {
    const place = at(event);
    if (!drag) return point(near(store, plot, place));
    const frame = plot.frame()!;
    drag.moved ||= Math.hypot(place[0] - drag.from[0], place[1] - drag.from[1]) > STILL;
    if (!drag.moved) return;
    point(-1);
    if (drag.kind === "pan")
      move(
        (drag.last[0] - place[0]) / (frame.right - frame.left),
        (place[1] - drag.last[1]) / (frame.bottom - frame.top),
      );
    else showBox(box, frame, drag.kind, drag.from, place);
    drag.last = place;
  });
  surface.addEventListener("pointerup", (event) => {
    const ended = drag;
    drag = null;
    box.hidden = true;
    if (ended?.moved && ended.kind !== "pan") return brushTo(store, plot, ended, at(event));
    if (ended?.moved || event.button !== 0) return;
    tellPlace(store, plot, at(event));
    const run = store.points().deciding(nearest(store, plot, at(event), CLICK_REACH, () => true));
    if (run < 0) return;
    if (event.shiftKey) togglePin(store, run);
    else selectRun(store, run);
  });
  surface.addEventListener("pointercancel", () => {
    drag = null;
    box.hidden = true;
  });
  surface.addEventListener("pointerleave", () => point(-1));
  surface.addEventListener("dblclick", () => store.set({ zoom: null }));
  surface.addEventListener(
    "wheel",
    (event) => {
      // Once all is shown, the wheel scrolls the page.
      if (event.deltaY > 0 && !store.state.zoom) return;
      event.preventDefault();
      point(-1);
      zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.002)), at(event));
    },
    { passive: false },
  );
  surface.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const direction = ARROWS[event.key];
    if (direction && event.shiftKey) move(direction[0] / 5, -direction[1] / 5);
    else if (direction) {
      point(-1);
      const run = store.points().deciding(neighbour(store, plot, direction));
      if (run >= 0) selectRun(store, run);
    } else if (event.key === "+" || event.key === "=") zoom(STEP, centre());
    else if (event.key === "-") zoom(1 / STEP, centre());
    else if (event.key === "0") store.set({ zoom: null });
    else if (event.key === "p" || event.key === "P") togglePin(store, store.state.selected);
    else return;
    event.preventDefault();
  });
  const tool = (id: string, text: string, title: string, click: () => void): HTMLButtonElement =>
    el("button", { id, type: "button", title, "aria-label": title, click }, text);
  const all = tool("zoom-all", "Whole plane", "Show the whole plane (double click, or key 0)", () =>
    store.set({ zoom: null }),
  );
  const enable = (): void => {
    all.disabled = !store.state.zoom;
  };
  enable();
  store.subscribe((_, changed) => {
    if (changed.has("zoom")) enable();
  });
  return [
    brush,
    tool("zoom-out", "\u2212", "Zoom out (wheel, or key \u2212)", () => zoom(1 / STEP, centre())),
    tool("zoom-in", "+", "Zoom in (wheel, or key +)", () => zoom(STEP, centre())),
    all,
  ];
}

function showBox(box: HTMLElement, frame: Frame, kind: Drag["kind"], from: Place, to: Place): void {
  const { left, right, top, bottom } = frame;
  const [x0, x1] =
    kind === "y"
      ? [left, right]
      : [clamp(Math.min(from[0], to[0]), left, right), clamp(Math.max(from[0], to[0]), left, right)];
  const [y0, y1] =
    kind === "x"
      ? [top, bottom]
      : [clamp(Math.min(from[1], to[1]), top, bottom), clamp(Math.max(from[1], to[1]), top, bottom)];
  box.hidden = false;
  box.style.left = `${x0}px`;
  box.style.top = `${y0}px`;
  box.style.width = `${x1 - x0}px`;
  box.style.height = `${y1 - y0}px`;
}

function brushTo({ state, set }: Store, plot: Plot, { from, kind }: Drag, to: Place): void {
  const { left, right, top, bottom, x, y } = plot.frame()!;
  const plane = plot.plane();
  let { brushes } = state;
  if (kind !== "y")
    brushes = rebrushed(brushes, `variable.${plane.x}`, [
      x.invert(clamp(from[0], left, right)),
      x.invert(clamp(to[0], left, right)),
    ]);
  if (kind !== "x")
    brushes = rebrushed(brushes, `variable.${plane.y}`, [
      y.invert(clamp(from[1], top, bottom)),
      y.invert(clamp(to[1], top, bottom)),
    ]);
  set({ brushes });
}

function clamp(value: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, value));
}

// The run under the pointer; one that has waveforms to show goes first.
/** Beside the runs, whoever wants to know hears where: a served report can simulate there. */
function tellPlace(store: Store, plot: Plot, [x, y]: Place): void {
  const frame = plot.frame();
  if (!frame || nearest(store, plot, [x, y], ON_RUN, () => true) >= 0) return;
  const detail = { x: frame.x.invert(x), y: frame.y.invert(y) };
  plot.surface.dispatchEvent(new CustomEvent("pointed-at", { bubbles: true, detail }));
}

function near(store: Store, plot: Plot, place: Place): number {
  const { deciding } = store.points();
  const kept = nearest(store, plot, place, REACH, (run) => isKept(store, deciding(run)));
  return deciding(kept >= 0 ? kept : nearest(store, plot, place, REACH, () => true));
}

function nearest(store: Store, plot: Plot, [x, y]: Place, reach: number, suits: (run: number) => boolean): number {
  const frame = plot.frame();
  if (!frame || x < frame.left - reach || x > frame.right + reach || y < frame.top - reach || y > frame.bottom + reach)
    return -1;
  const { study } = store;
  const plane = plot.plane();
  const [xs, ys] = [study.variables[plane.x]!.values, study.variables[plane.y]!.values];
  // The scales are linear; asking them for every one of a million runs would take too long.
  const [x0, x1, y0, y1] = [frame.x(0), frame.x(1) - frame.x(0), frame.y(0), frame.y(1) - frame.y(0)];
  const { within } = store.points();
  let best = -1;
  let least = reach * reach;
  for (const run of shownRuns(store)) {
    const square = (x0 + x1 * xs[run]! - x) ** 2 + (y0 + y1 * ys[run]! - y) ** 2;
    if (square < least && (!within || within[run]) && suits(run)) {
      least = square;
      best = run;
    }
  }
  return best;
}

/** The closest run in a direction; steps aside count three times, so that a row of a grid is kept. */
export function neighbour(store: Store, plot: Plot, [dx, dy]: Place): number {
  const frame = plot.frame();
  const runs = shownRuns(store);
  if (!frame || !runs.length) return -1;
  const from = store.points().first(store.state.selected);
  if (from < 0 || !runs.includes(from)) return runs[0]!;
  const [x, y] = placeOf(frame, store.study, plot.plane(), from);
  let best = -1;
  let least = Infinity;
  for (const run of runs) {
    const [a, b] = placeOf(frame, store.study, plot.plane(), run);
    const along = (a - x) * dx + (b - y) * dy;
    const aside = Math.abs((a - x) * dy) + Math.abs((b - y) * dx);
    if (along < 0.5 || aside > 2 * along) continue;
    const score = along + 3 * aside;
    if (score < least) {
      least = score;
      best = run;
    }
  }
  return best;
}
