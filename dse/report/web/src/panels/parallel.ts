// Every run as a line across axes the reader chooses and orders; dragging along an axis brushes it.
import { selectRun, setSetting, togglePin } from "../actions";
import { rebrushed } from "../brush";
import { el } from "../dom";
import { group } from "../format";
import { createMenu } from "../menu";
import { fitted } from "../plot/frame";
import { type Axis, axesOf, FOOT, heightsOf, nearestLine, paintLines, placeOf, SIDE, TOP } from "../plot/parallel";
import { type Part, paintedBy, type Sheet } from "../plot/sheet";
import type { State, Store } from "../store";
import { palette } from "../theme";

const MOST_LINES = 1200;
const LEAST_ROOM = 104;
const TITLE = 36;
const REACH = 16;
const STILL = 3;
const ORDER = "runs.axes";
const GROUPS: [string, string][] = [
  ["variable", "Design variables"],
  ["metric", "Metrics"],
  ["property", "Properties"],
];
const REPAINTED: (keyof State)[] = ["thresholds", "selected", "theme", "brushes", "pins", "hovered"];

/** The axes, and their picture as they are shown. */
export function createParallel(store: Store): { box: HTMLElement; picture: () => Part[] } {
  const { study } = store;
  const all = axesOf(study);
  const canvas = el("canvas", {
    class: "parallel",
    tabindex: 0,
    role: "img",
    "aria-label": "Every run as a line across the chosen axes; the table below has the same numbers",
  });
  const heads = el("div", { class: "heads" });
  const inner = el("div", { class: "parallel-inner" }, heads, canvas);
  const scroll = el("div", { class: "parallel-scroll" }, inner);
  const note = el("p", { class: "hint" });
  let axes: Axis[] = [];
  let lines: { inside: number[]; outside: number[] } = { inside: [], outside: [] };

  const paint = paintedBy(canvas, (sheet) => paintLines(sheet, store, axes, lines));
  const sample = (): void => {
    const within = store.within();
    const done = Array.from(study.number.keys()).filter((run) => study.done[run]);
    const inside = within ? done.filter((run) => within[run]) : done;
    const outside = within ? done.filter((run) => !within[run]) : [];
    lines = { inside: thinned(inside), outside: thinned(outside) };
    const share =
      lines.inside.length < inside.length
        ? `${group(lines.inside.length)} of ${group(inside.length)} lines are drawn. `
        : "";
    note.textContent = `${share}Green lines meet every requirement that is switched on, the thick line is the selected run, bars are the thresholds. Drag along an axis to brush it, click it to clear; drag a heading, or use its arrow keys, to move an axis.`;
  };
  const layout = (): void => {
    axes = chosen(store, all);
    inner.style.width = `${Math.max(scroll.clientWidth, axes.length * LEAST_ROOM)}px`;
    const room = (inner.clientWidth - 2 * SIDE) / Math.max(1, axes.length - 1);
    const focused = document.activeElement?.id;
    heads.replaceChildren(
      ...axes.map((axis, index) =>
        head(store, axes, axis, index, placeOf(axes.length, inner.clientWidth, index), Math.min(room, 2 * SIDE)),
      ),
    );
    if (focused?.startsWith("head-")) document.getElementById(focused)?.focus();
    paint();
  };
  attach(
    store,
    canvas,
    () => axes,
    () => [...lines.inside, ...lines.outside],
  );
  store.subscribe((_, changed) => {
    if (changed.has("brushes")) sample();
    if (changed.has("settings")) layout();
    else if (REPAINTED.some((key) => changed.has(key))) paint();
  });
  new ResizeObserver(layout).observe(scroll);
  sample();
  const titled = ({ pen, width, height }: Sheet): void => {
    const colours = palette();
    pen.save();
    pen.fillStyle = colours.ink;
    pen.font = `600 12px ${colours.font}`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    const room = Math.min((width - 2 * SIDE) / Math.max(1, axes.length - 1), 2 * SIDE) - 6;
    axes.forEach(({ title }, index) => {
      const unit = title.lastIndexOf(" [");
      [title.slice(0, unit), title.slice(unit + 1)].forEach((text, line) =>
        pen.fillText(fitted(pen, text, room), placeOf(axes.length, width, index), (line + 0.7) * (TITLE / 2)),
      );
    });
    pen.restore();
    pen.translate(0, TITLE);
    paintLines({ pen, width, height: height - TITLE }, store, axes, lines);
  };
  const picture = (): Part[] => [
    { title: "", width: canvas.clientWidth, height: canvas.clientHeight + TITLE, paint: titled },
  ];
  return { box: el("div", {}, chooser(store, all), scroll, note), picture };
}

function thinned(runs: number[]): number[] {
  return runs.length <= MOST_LINES
    ? runs
    : Array.from({ length: MOST_LINES }, (_, index) => runs[Math.floor((index * runs.length) / MOST_LINES)]!);
}

function chosen({ state }: Store, all: Axis[]): Axis[] {
  const keys = state.settings[ORDER]?.split(",") ?? [];
  const picked = [...new Set(keys)].flatMap((key) => all.find((axis) => axis.key === key) ?? []);
  return picked.length ? picked : all;
}

function reorder(store: Store, axes: Axis[]): void {
  setSetting(store, ORDER, axes.map(({ key }) => key).join());
}

function moved(axes: Axis[], from: number, to: number): Axis[] {
  const others = axes.filter((_, index) => index !== from);
  others.splice(Math.min(others.length, Math.max(0, to)), 0, axes[from]!);
  return others;
}

function head(store: Store, axes: Axis[], axis: Axis, index: number, x: number, room: number): HTMLElement {
  const button = el(
    "button",
    {
      id: `head-${axis.key}`,
      class: "head-axis",
      type: "button",
      title: `${axis.title}: drag, or the arrow keys, to move; Delete takes it away`,
    },
    el("span", {}, axis.title),
  );
  button.style.left = `${x}px`;
  button.style.width = `${room - 6}px`;
  button.addEventListener("keydown", (event) => {
    const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (step) reorder(store, moved(axes, index, index + step));
    else if ((event.key === "Delete" || event.key === "Backspace") && axes.length > 1)
      reorder(
        store,
        axes.filter((other) => other !== axis),
      );
    else return;
    event.preventDefault();
  });
  button.addEventListener("pointerdown", (event) => {
    button.setPointerCapture(event.pointerId);
    const from = event.clientX;
    const follow = (moving: PointerEvent): void => {
      button.style.transform = `translateX(calc(-50% + ${moving.clientX - from}px))`;
    };
    const drop = (ended: PointerEvent): void => {
      button.removeEventListener("pointermove", follow);
      button.style.transform = "";
      const width = button.parentElement!.clientWidth;
      const step = (width - 2 * SIDE) / Math.max(1, axes.length - 1);
      const to = index + Math.round((ended.clientX - from) / step);
      if (to !== index) reorder(store, moved(axes, index, to));
    };
    button.addEventListener("pointermove", follow);
    button.addEventListener("pointerup", drop, { once: true });
  });
  return button;
}

function chooser(store: Store, all: Axis[]): HTMLElement {
  const list = el("div", { class: "axes" });
  const draw = (): void => {
    const shown = chosen(store, all);
    const set = (keys: string[]): void =>
      reorder(
        store,
        keys.flatMap((key) => all.find((axis) => axis.key === key) ?? []),
      );
    const keys = shown.map(({ key }) => key);
    const focused = document.activeElement?.id;
    const named = new Set(GROUPS.map(([prefix]) => prefix));
    const groups = [
      ...GROUPS,
      ...[...new Set(all.map(({ key }) => prefixOf(key)))]
        .filter((prefix) => !named.has(prefix))
        .map((prefix): [string, string] => [prefix, "Others"]),
    ];
    list.replaceChildren(
      ...groups.flatMap(([prefix, title]) => {
        const members = all.filter(({ key }) => prefixOf(key) === prefix);
        if (!members.length) return [];
        const only = el(
          "button",
          { type: "button", class: "bare", id: `only-${prefix}`, click: () => set(members.map(({ key }) => key)) },
          "only these",
        );
        return [
          el(
            "fieldset",
            {},
            el("legend", {}, title, only),
            ...members.map((axis) =>
              el(
                "label",
                {},
                el("input", {
                  id: `axis-${axis.key}`,
                  type: "checkbox",
                  checked: keys.includes(axis.key),
                  change: (event: Event) =>
                    set(
                      (event.target as HTMLInputElement).checked
                        ? [...keys, axis.key]
                        : keys.filter((key) => key !== axis.key),
                    ),
                }),
                el("span", {}, axis.title),
              ),
            ),
          ),
        ];
      }),
      el(
        "button",
        { type: "button", id: "all-axes", click: () => setSetting(store, ORDER, "") },
        "All, in the study\u2019s order",
      ),
    );
    if (focused) document.getElementById(focused)?.focus();
  };
  store.subscribe((_, changed) => {
    if (changed.has("settings")) draw();
  });
  draw();
  const menu = createMenu("choose-axes", "Axes", "Choose the axes", list);
  menu.classList.add("left-menu");
  return menu;
}

function prefixOf(key: string): string {
  return key.split(".")[0]!;
}

function attach(store: Store, canvas: HTMLCanvasElement, axes: () => Axis[], lines: () => number[]): void {
  let drag: { axis: Axis; from: number; moved: boolean } | null = null;
  const axisAt = (x: number): Axis | null => {
    const shown = axes();
    const index = shown.findIndex((_, i) => Math.abs(placeOf(shown.length, canvas.clientWidth, i) - x) < REACH);
    return shown[index] ?? null;
  };
  const brush = (axis: Axis, from: number, to: number): void => {
    const scale = heightsOf([axis], canvas.clientHeight)[0]!;
    // An axis shows the bulk of the values; to its end means to the last of them.
    const end = (y: number): number =>
      y <= TOP ? axis.most : y >= canvas.clientHeight - FOOT ? axis.least : scale.invert(y);
    store.set({ brushes: rebrushed(store.state.brushes, axis.key, [end(from), end(to)]) });
  };
  canvas.addEventListener("pointerdown", (event) => {
    const axis = axisAt(event.offsetX);
    if (!axis || event.button !== 0) return;
    drag = { axis, from: event.offsetY, moved: false };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (drag) {
      drag.moved ||= Math.abs(event.offsetY - drag.from) > STILL;
      if (drag.moved) brush(drag.axis, drag.from, event.offsetY);
      return;
    }
    canvas.classList.toggle("on-axis", axisAt(event.offsetX) !== null);
    store.set({ hovered: nearestLine(canvas, axes(), lines(), event.offsetX, event.offsetY) });
  });
  canvas.addEventListener("pointerleave", () => store.set({ hovered: -1 }));
  canvas.addEventListener("pointerup", (event) => {
    const ended = drag;
    drag = null;
    if (ended?.moved) return;
    if (ended && store.state.brushes.some(({ column }) => column === ended.axis.key))
      return store.set({ brushes: rebrushed(store.state.brushes, ended.axis.key, null) });
    const run = nearestLine(canvas, axes(), lines(), event.offsetX, event.offsetY);
    if (run < 0) return;
    if (event.shiftKey) togglePin(store, run);
    else selectRun(store, run);
  });
}
