// Any column over any other: point to see, click to select, drag a rectangle to set everything else back.
import { selectRun } from "../../actions";
import { rebrushed } from "../../brush";
import { columnsOf } from "../../columns";
import { choose, el, field } from "../../dom";
import { count, group, number, withUnit } from "../../format";
import { badge } from "../../panels/selected";
import { drawAxes, drawGrid, type Frame } from "../../plot/frame";
import { dotEntry, type Entry, markEntry } from "../../plot/legend";
import { type Part, paintedBy, partsIn, type Sheet } from "../../plot/sheet";
import type { Places } from "../../plot/stamps";
import { axisLabel } from "../../study";
import { palette } from "../../theme";
import type { Mark } from "../../verdicts";
import { type Cloud, cloudFrame, cloudOf, paintCloud, paintFront, placesOf } from "./cloud";
import { type Colouring, colouringOf, colourOptions } from "./colouring";
import { isLarge, type Model, nameOf, subscribeCalmly } from "./model";
import { designColumns } from "./values";

const REACH = 22;
const DRAG = 5;
/** What a point's sign says, by its mark. */
const MARKS = ["feasible", "misses a requirement", "undecided", "failed to run"];
const FILLED = "filled: feasible; rings: not";

interface Drawn {
  cloud: Cloud;
  frame: Frame;
  places: Places;
  colouring: Colouring;
}

/** The scatter, and its picture as it is shown. */
export function createScatter(model: Model): { box: HTMLElement; picture: () => Part[] } {
  const { store } = model;
  const ground = el("canvas", { "aria-hidden": "true" });
  const overlay = el("canvas", { "aria-hidden": "true" });
  const tip = el("div", { class: "tip", "aria-hidden": "true", hidden: true });
  const surface = el(
    "div",
    { class: "plot cloud", id: "cloud", tabindex: 0, role: "application", "aria-roledescription": "scatter plot" },
    ground,
    overlay,
    tip,
  );
  const controls = el("div", { class: "row" });
  const legend = el("ul", { class: "legend" });
  const note = el("p", { class: "hint", id: "cloud-note" });
  let drawn: Drawn | null = null;
  // The front of a large study is found when a slider rests; until then there is none.
  let resting = true;
  let hovered = -1;
  let dragged: [number, number, number, number] | null = null;

  const paintGround = paintedBy(
    ground,
    ({ pen, width, height }) => {
      const colours = palette();
      const cloud = cloudOf(model);
      const frame = cloudFrame(width, height, cloud);
      const places = samePlaces(drawn, cloud, frame) ?? placesOf(cloud, frame);
      const colouring = colouringOf(model, colours);
      drawn = { cloud, frame, places, colouring };
      pen.fillStyle = colours.plot;
      pen.fillRect(frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
      drawGrid(pen, frame, cloud.x, cloud.y, colours);
      paintCloud(pen, frame, cloud, places, colouring, colours);
      if (resting && model.choices.points === "designs" && model.choices.criteria.length > 1)
        paintFront(pen, frame, model, model.front(), places, colours);
      drawAxes(pen, frame, cloud.x, cloud.y, colours);
    },
    { legend: () => (drawn ? keyOf(drawn.colouring) : []) },
  );
  const paint = (): void => {
    paintGround();
    if (!surface.clientWidth || !drawn) return;
    const { cloud, colouring } = drawn;
    legend.replaceChildren(...legendOf(colouring));
    note.textContent = noteOf(model, drawn, resting);
    surface.setAttribute(
      "aria-label",
      `${axisLabel(cloud.y)} over ${axisLabel(cloud.x)}. ${note.textContent} Arrow keys select the next point.`,
    );
    mark();
  };
  const mark = paintedBy(overlay, (sheet) => {
    if (drawn) paintOverlay(sheet, model, drawn, hovered, dragged);
  });
  const at = (event: PointerEvent): [number, number] => {
    const box = surface.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const hover = (point: number): void => {
    if (point === hovered || !drawn) return;
    hovered = point;
    store.set({ hovered: point < 0 ? -1 : drawn.cloud.run(point) });
    showTip(tip, surface, model, drawn, point);
    mark();
  };
  surface.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    dragged = [...at(event), ...at(event)];
    surface.setPointerCapture(event.pointerId);
  });
  surface.addEventListener("pointermove", (event) => {
    const [x, y] = at(event);
    if (dragged) {
      dragged = [dragged[0], dragged[1], x, y];
      if (isDrag(dragged)) hover(-1);
      return mark();
    }
    if (drawn) hover(nearest(drawn, x, y, REACH));
  });
  surface.addEventListener("pointerleave", () => hover(-1));
  surface.addEventListener("pointercancel", () => {
    dragged = null;
    mark();
  });
  surface.addEventListener("pointerup", (event) => {
    const drag = dragged;
    dragged = null;
    if (!drag || !drawn) return;
    if (isDrag(drag)) return brush(model, drawn.frame, drag);
    const point = nearest(drawn, ...at(event), 2 * REACH);
    if (point >= 0) selectRun(store, drawn.cloud.run(point));
    mark();
  });
  surface.addEventListener("keydown", (event) => {
    if (!drawn || event.altKey || event.ctrlKey || event.metaKey) return;
    if (event.key === "Escape") {
      // An enlarged panel is left with the next one.
      if (store.state.brushes.length) event.preventDefault();
      return clear(model);
    }
    const step = { ArrowLeft: -1, ArrowRight: 1, ArrowDown: -1, ArrowUp: 1 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const point = neighbour(
      drawn,
      drawn.cloud.point(store.state.selected),
      event.key === "ArrowUp" || event.key === "ArrowDown" ? "y" : "x",
      step,
    );
    if (point >= 0) selectRun(store, drawn.cloud.run(point));
  });
  const drawControls = (): void => {
    const focused = (document.activeElement as HTMLElement | null)?.id;
    controls.replaceChildren(...controlsOf(model));
    if (focused) document.getElementById(focused)?.focus();
  };
  const judging = ["criteria", "demand", "thresholds", "brushes"] as const;
  if (isLarge(model)) {
    subscribeCalmly(model, (changed) => {
      resting = true;
      if (judging.some((key) => changed.has(key))) paint();
    });
  }
  model.subscribe((changed) => {
    if (isLarge(model) && judging.some((key) => changed.has(key))) resting = false;
    if (["x", "y", "colour", "points", "brushes"].some((key) => changed.has(key as "x"))) drawControls();
    if (
      ["x", "y", "colour", "points", "criteria", "demand", "thresholds", "brushes", "theme"].some((key) =>
        changed.has(key as "x"),
      )
    )
      paint();
    else if (["selected", "hovered", "pins", "picked"].some((key) => changed.has(key as "pins"))) mark();
  });
  new ResizeObserver(paint).observe(surface);
  drawControls();
  return {
    box: el("div", {}, el("div", { class: "controls" }, controls), surface, legend, note),
    picture: () => partsIn(surface),
  };
}

// A slider that moves verdicts moves no point.
function samePlaces(last: Drawn | null, { x, y }: Cloud, frame: Frame): Places | null {
  if (last?.cloud.x.values !== x.values || last.cloud.y.values !== y.values) return null;
  return (["left", "right", "top", "bottom"] as const).every((side) => last.frame[side] === frame[side])
    ? last.places
    : null;
}

function controlsOf(model: Model): HTMLElement[] {
  const { choices, grouping, store } = model;
  const columns = choices.points === "runs" ? columnsOf(store.study) : designColumns(store.study);
  const options = columns.map((column): [string, string] => [column.key, axisLabel(column)]);
  const axis = (key: "x" | "y", text: string): HTMLElement => {
    const select = choose(options, choices[key], (value) => model.set({ [key]: value }));
    select.id = `cloud-${key}`;
    return field(text, select);
  };
  const colour = choose(colourOptions(model), choices.colour, (value) => model.set({ colour: value }));
  colour.id = "cloud-colour";
  const several = grouping.size < store.study.size;
  const points = choose(
    [
      ["designs", "a design at its worst condition"],
      ["runs", "a run"],
    ],
    choices.points,
    (value) => {
      const known = (value === "runs" ? columnsOf(store.study) : designColumns(store.study)).map(({ key }) => key);
      const keep = (key: string): string => (known.includes(key) ? key : known[0]!);
      model.set({ points: value as "designs" | "runs", x: keep(choices.x), y: keep(choices.y) });
    },
  );
  points.id = "cloud-points";
  const parts = [axis("x", "Across"), axis("y", "Up"), field("Colour", colour)];
  if (several) parts.push(field("A point is", points));
  if (store.state.brushes.length)
    parts.push(
      el(
        "button",
        { id: "cloud-clear", type: "button", class: "clear", click: () => clear(model) },
        store.state.brushes.length > 1 ? "Clear brushes" : "Clear brush",
      ),
    );
  return parts;
}

function clear(model: Model): void {
  if (model.store.state.brushes.length) model.store.set({ brushes: [] });
}

function isDrag([a, b, c, d]: [number, number, number, number]): boolean {
  return Math.abs(c - a) > DRAG || Math.abs(d - b) > DRAG;
}

function brush({ store, choices }: Model, frame: Frame, [a, b, c, d]: [number, number, number, number]): void {
  const across = rebrushed(store.state.brushes, choices.x, [frame.x.invert(a), frame.x.invert(c)]);
  store.set({
    brushes: choices.y === choices.x ? across : rebrushed(across, choices.y, [frame.y.invert(b), frame.y.invert(d)]),
  });
}

function nearest({ cloud, places: { a, b } }: Drawn, x: number, y: number, reach: number): number {
  let best = -1;
  let least = reach * reach;
  for (let point = 0; point < a.length; point++) {
    if (cloud.within && !cloud.within[point]) continue;
    const square = (a[point]! - x) ** 2 + (b[point]! - y) ** 2;
    if (square < least) {
      least = square;
      best = point;
    }
  }
  return best;
}

/** The next point along an axis, those at the same value in their order. */
function neighbour({ cloud }: Drawn, from: number, axis: "x" | "y", step: number): number {
  const { values } = cloud[axis];
  const after = (a: number, b: number): boolean =>
    step * (values[a]! - values[b]!) > 0 || (values[a] === values[b] && step * (a - b) > 0);
  let best = -1;
  for (let point = 0; point < values.length; point++) {
    if (Number.isNaN(values[point]!) || (cloud.within && !cloud.within[point])) continue;
    if ((from < 0 || after(point, from)) && (best < 0 || after(best, point))) best = point;
  }
  return best;
}

function paintOverlay(
  { pen }: Sheet,
  model: Model,
  { cloud, frame, places }: Drawn,
  hovered: number,
  dragged: [number, number, number, number] | null,
): void {
  const colours = palette();
  const { state } = model.store;
  const ring = (point: number, colour: string, width: number): void => {
    const [x, y] = [places.a[point]!, places.b[point]!];
    if (point < 0 || Number.isNaN(x + y)) return;
    for (const [stroke, wide] of [
      [colours.plot, width + 3],
      [colour, width],
    ] as const) {
      pen.beginPath();
      pen.arc(x, y, 6 + width, 0, 2 * Math.PI);
      pen.strokeStyle = stroke;
      pen.lineWidth = wide;
      pen.stroke();
    }
  };
  model.choices.picked.forEach((design, index) => {
    if (model.choices.points === "designs")
      ring(design, colours.requirements[index % colours.requirements.length]!, 2.4);
  });
  for (const run of state.pins) ring(cloud.point(run), colours.target, 1.6);
  ring(hovered >= 0 ? hovered : state.hovered >= 0 ? cloud.point(state.hovered) : -1, colours.ink, 1.2);
  if (state.selected >= 0) ring(cloud.point(state.selected), colours.ink, 2.2);
  const box = dragged && isDrag(dragged) ? dragged : brushed(model, frame);
  if (!box) return;
  const [x0, x1] = [Math.min(box[0], box[2]), Math.max(box[0], box[2])].map((x) =>
    Math.min(frame.right, Math.max(frame.left, x)),
  ) as [number, number];
  const [y0, y1] = [Math.min(box[1], box[3]), Math.max(box[1], box[3])].map((y) =>
    Math.min(frame.bottom, Math.max(frame.top, y)),
  ) as [number, number];
  pen.strokeStyle = colours.current;
  pen.lineWidth = 1.2;
  pen.setLineDash([4, 3]);
  pen.strokeRect(x0, y0, x1 - x0, y1 - y0);
  pen.setLineDash([]);
}

// The brushes on these axes; without any, nothing.
function brushed({ store, choices }: Model, frame: Frame): [number, number, number, number] | null {
  const on = (key: string) => store.state.brushes.find(({ column }) => column === key);
  const [x, y] = [on(choices.x), on(choices.y)];
  if (!x && !y) return null;
  return [
    x ? frame.x(x.low) : frame.left,
    y ? frame.y(y.low) : frame.bottom,
    x ? frame.x(x.high) : frame.right,
    y ? frame.y(y.high) : frame.top,
  ];
}

function showTip(tip: HTMLElement, surface: HTMLElement, model: Model, { cloud, places }: Drawn, point: number): void {
  tip.hidden = point < 0;
  if (point < 0) return;
  const { store, choices } = model;
  const line = (name: string, value: string): HTMLElement =>
    el("div", { class: "line" }, el("span", {}, name), el("b", {}, value));
  const value = ({ title, unit, values, text }: Cloud["x"]): HTMLElement =>
    line(title, withUnit(text(values[point]!), unit));
  const score = choices.points === "designs" ? model.scores()[point]! : NaN;
  const name = choices.points === "designs" ? nameOf(model, point) : `Run ${store.study.number[point]}`;
  tip.replaceChildren(
    el("div", { class: "head" }, name, badge(cloud.marks[point]!)),
    value(cloud.x),
    value(cloud.y),
    ...(Number.isNaN(score) ? [] : [line("score", score.toFixed(3))]),
  );
  const [x, y] = [places.a[point]!, places.b[point]!];
  const { offsetWidth: width, offsetHeight: height } = tip;
  tip.style.left = `${x + 16 + width > surface.clientWidth ? Math.max(0, x - width - 14) : x + 14}px`;
  tip.style.top = `${Math.min(Math.max(4, y - height / 2), surface.clientHeight - height - 4)}px`;
}

function legendOf({ codes, colours, names, range, column }: Colouring): HTMLElement[] {
  if (!codes)
    return MARKS.map((text, mark) =>
      el("li", {}, el("span", { class: `sign ${["pass", "fail", "open", "broken"][mark]}` }), text),
    );
  const swatch = (colour: string): HTMLElement => {
    const box = el("span", { class: "dot" });
    box.style.background = colour;
    return box;
  };
  const filled = el("li", {}, FILLED);
  if (!column) return [...names.map((name, code) => el("li", {}, swatch(colours[code]!), name)), filled];
  const ramp = el("span", { class: "ramp" });
  ramp.style.background = `linear-gradient(to right, ${colours.slice(0, -1).join(", ")})`;
  return range
    ? [el("li", {}, withUnit(number(range[0]), column.unit), ramp, withUnit(number(range[1]), column.unit)), filled]
    : [el("li", {}, "no values")];
}

// The same for a picture that is saved.
function keyOf({ codes, colours, names, range, column }: Colouring): Entry[] {
  if (!codes) return MARKS.map((text, mark) => markEntry(mark as Mark, text));
  const filled = { text: FILLED, draw: () => undefined };
  if (!column) return [...names.map((name, code) => dotEntry(name, colours[code]!)), filled];
  if (!range) return [];
  const [low, high] = range;
  return [
    dotEntry(withUnit(number(low), column.unit), colours[0]!),
    dotEntry(withUnit(number((low + high) / 2), column.unit), colours[(colours.length - 1) >> 1]!),
    dotEntry(`${withUnit(number(high), column.unit)} (${column.title})`, colours.at(-2)!),
    filled,
  ];
}

function noteOf(model: Model, { cloud, places: { a, b } }: Drawn, resting: boolean): string {
  const { choices } = model;
  let shown = 0;
  let inside = 0;
  for (let point = 0; point < a.length; point++) {
    if (Number.isNaN(a[point]! + b[point]!)) continue;
    shown++;
    inside += cloud.within?.[point] ?? 1;
  }
  const noun = choices.points === "designs" ? "design" : "run";
  const {
    x: { values: xs },
    y: { values: ys },
  } = cloud;
  const missing = xs.reduce((sum, x, point) => sum + (Number.isFinite(x + ys[point]!) ? 0 : 1), 0);
  const beyond = a.length - shown - missing;
  const parts = [
    cloud.within ? `${group(inside)} of ${count(shown, noun)} within the brushes` : count(shown, noun),
    ...(missing ? [`${group(missing)} without a value on both axes`] : []),
    ...(beyond ? [`${group(beyond)} that do not exercise every requirement beyond the axes`] : []),
  ];
  const told = `${parts.join(", ")}.`;
  const hint = " Click a point, drag a rectangle to brush; Escape clears.";
  if (!resting || choices.points === "runs" || choices.criteria.length < 2) return told + hint;
  const onFront = model.front().reduce((sum, one) => sum + one, 0);
  const names = choices.criteria
    .map(({ column, maximize }) => `${model.column(column).title} ${maximize ? "\u2191" : "\u2193"}`)
    .join(", ");
  const front = onFront ? ` Ringed: the ${onFront} on the Pareto front of ${names}, among feasible designs.` : "";
  return told + front + hint;
}
