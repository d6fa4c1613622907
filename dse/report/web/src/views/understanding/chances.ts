// How probable it is between the runs that a requirement is met: one heat map each, with the band of doubt.
import { contours } from "d3-contour";
import { scaleLinear } from "d3-scale";
import { el } from "../../dom";
import { group, number, percent, withUnit } from "../../format";
import type { ChanceMap } from "../../insight";
import { liesIn } from "../../plane/plane";
import { clipTo, drawAxes, type Frame } from "../../plot/frame";
import type { Pen } from "../../plot/pen";
import type { Sheet } from "../../plot/sheet";
import type { Store } from "../../store";
import { type Palette, palette, shade } from "../../theme";
import { createPainted } from "../shared/canvas";
import { placeAt } from "../shared/places";
import { planeName } from "../shared/planes";
import { positionOf } from "../shared/runs";

const DOUBTFUL = 5;
const TICKS = 5;

export function createChances(store: Store): HTMLElement {
  const { chances, withheld } = store.study.insight!;
  return el(
    "div",
    {},
    el(
      "p",
      { class: "hint" },
      "Colour: the probability that the requirement is met, from a Gaussian process fitted to the runs, at the study\u2019s own thresholds. Dashed: the band in which the likelier verdict is wrong with a probability above 5 %. Frame: the ranges that may change at once around the robust centre. The constraint plot shows the boundary itself, interpolated between the runs.",
    ),
    el(
      "div",
      { class: "minis maps" },
      ...chances.map((map, index) =>
        chanceFigure(store, map, `chances-${index}`, store.study.requirements[map.requirement]!.title),
      ),
    ),
    ...withheld
      .filter((text) => text.startsWith("chances of "))
      .map((text) => el("p", { class: "hint withheld" }, `Withheld: ${text}.`)),
  );
}

/** What is drawn over a map: *at* is where a place (0 … 1) of both variables is. */
export type Over = (pen: Pen, at: (across: number, up: number) => [number, number], colours: Palette) => void;

export function chanceFigure(store: Store, map: ChanceMap, id: string, title: string, over?: Over): HTMLElement {
  const { study } = store;
  const reading = el("p", { class: "reading" }, "\u00a0");
  const label = `Probability that ${title} is met over ${planeName(study, map.plane)}; the verdict is in doubt on ${percent(map.uncertain, 1)} of it`;
  const painted = createPainted(
    store,
    "mini map",
    label,
    (sheet) => paint(sheet, store, map, over),
    () => title,
  );
  painted.element.id = id;
  painted.element.addEventListener("pointermove", (event) => {
    const frame = frameOf(painted.canvas.clientWidth, painted.canvas.clientHeight);
    const box = painted.canvas.getBoundingClientRect();
    reading.textContent = read(
      map,
      frame.x.invert(event.clientX - box.left) / (TICKS - 1),
      frame.y.invert(event.clientY - box.top) / (TICKS - 1),
    );
  });
  painted.element.addEventListener("pointerleave", () => (reading.textContent = "\u00a0"));
  store.subscribe((_, changed) => {
    if (changed.has("selected") && painted.element.isConnected) painted.repaint();
  });
  const held = map.held.map(
    ([variable, value]) =>
      `${study.variables[variable]!.title} ${withUnit(number(value), study.variables[variable]!.unit)}`,
  );
  const configuration =
    study.configurations.length > 1 ? ` Configuration ${study.configurations[map.configuration]!.id}.` : "";
  const from =
    map.used < map.runs ? `${group(map.used)} drawn from ${group(map.runs)} runs` : `${group(map.runs)} runs`;
  return el(
    "figure",
    {},
    el("figcaption", {}, el("b", {}, title), el("span", {}, `in doubt on ${percent(map.uncertain, 1)} of the plane`)),
    painted.element,
    reading,
    el(
      "p",
      { class: "hint" },
      `From ${from}.${configuration}${map.conditions > 1 ? ` At the worst of ${map.conditions} conditions.` : ""}${held.length ? ` Held: ${held.join(", ")}.` : ""}`,
    ),
  );
}

function frameOf(width: number, height: number): Frame {
  const frame = { left: 66, right: width - 54, top: 10, bottom: height - 50 };
  // The axes count ticks: even places, whatever the scale of the variable is.
  return {
    ...frame,
    x: scaleLinear([0, TICKS - 1], [frame.left, frame.right]),
    y: scaleLinear([0, TICKS - 1], [frame.bottom, frame.top]),
  };
}

function paint({ pen, width, height }: Sheet, store: Store, map: ChanceMap, over?: Over): void {
  const colours = palette();
  const frame = frameOf(width, height);
  const { left, right, top, bottom } = frame;
  const { size } = map;
  const [across, up] = [(right - left) / (size - 1), (bottom - top) / (size - 1)];
  const at = (i: number, j: number): [number, number] => [left + i * across, bottom - j * up];
  pen.save();
  clipTo(pen, frame);
  for (let j = 0; j < size; j++) {
    for (let i = 0; i < size; i++) {
      const [x, y] = at(i - 0.5, j + 0.5);
      pen.fillStyle = shade(colours.ramp, map.passing[j * size + i]! / 100);
      pen.fillRect(x, y, across + 0.6, up + 0.6);
    }
  }
  line(pen, map.misjudged, size, DOUBTFUL, at, colours, [4, 3], 1.4);
  frameOfCentre(pen, store, map, frame, colours);
  over?.(pen, (a, b) => [frame.x(a * (TICKS - 1)), frame.y(b * (TICKS - 1))], colours);
  cross(pen, store, map, frame, colours);
  pen.restore();
  drawAxes(pen, frame, ticks(store, map, 0), ticks(store, map, 1), colours);
  key(pen, frame, colours);
}

function line(
  pen: Pen,
  values: Uint8Array,
  size: number,
  level: number,
  at: (i: number, j: number) => [number, number],
  colours: Palette,
  dash: number[],
  width: number,
): void {
  pen.beginPath();
  for (const polygon of contours().size([size, size]).contour(Array.from(values), level).coordinates) {
    for (const ring of polygon) {
      ring.forEach(([i, j], index) => {
        const [x, y] = at(i! - 0.5, j! - 0.5);
        if (index) pen.lineTo(x, y);
        else pen.moveTo(x, y);
      });
    }
  }
  for (const [colour, thick] of [
    [colours.plot, width + 2],
    [colours.ink, width],
  ] as const) {
    pen.strokeStyle = colour;
    pen.lineWidth = thick;
    pen.setLineDash(colour === colours.ink ? dash : []);
    pen.stroke();
  }
  pen.setLineDash([]);
}

function frameOfCentre(pen: Pen, store: Store, map: ChanceMap, { x, y }: Frame, colours: Palette): void {
  const { study } = store;
  for (const centre of study.insight!.centres) {
    const ranges = map.plane.map((variable) => centre.ranges.find((range) => range.variable === variable));
    if (ranges.some((range) => !range)) continue;
    const run = positionOf(study, centre.run);
    if (run < 0 || !inPlane(store, map, run)) continue;
    const [h, v] = ranges.map((range, axis) => [
      placeOf(store, map.plane[axis]!, range!.low),
      placeOf(store, map.plane[axis]!, range!.high),
    ]) as [number[], number[]];
    pen.strokeStyle = colours.target;
    pen.lineWidth = 2;
    pen.strokeRect(x(h[0]!), y(v[1]!), x(h[1]!) - x(h[0]!), y(v[0]!) - y(v[1]!));
    pen.fillStyle = colours.target;
    pen.fillRect(
      x(placeOf(store, map.plane[0], study.variables[map.plane[0]]!.values[run]!)) - 3,
      y(placeOf(store, map.plane[1], study.variables[map.plane[1]]!.values[run]!)) - 3,
      6,
      6,
    );
  }
}

function cross(
  pen: Pen,
  store: Store,
  map: ChanceMap,
  { x, y, left, right, top, bottom }: Frame,
  colours: Palette,
): void {
  const run = store.state.selected;
  if (run < 0 || !inPlane(store, map, run)) return;
  const [a, b] = map.plane.map((variable) =>
    placeOf(store, variable, store.study.variables[variable]!.values[run]!),
  ) as [number, number];
  pen.beginPath();
  pen.moveTo(x(a), top);
  pen.lineTo(x(a), bottom);
  pen.moveTo(left, y(b));
  pen.lineTo(right, y(b));
  pen.strokeStyle = colours.current;
  pen.lineWidth = 1;
  pen.stroke();
}

// Only what lies in the plane is drawn in it.
function inPlane({ study }: Store, map: ChanceMap, run: number): boolean {
  const fixed = study.variables.map(({ nominal }) => nominal);
  for (const [variable, value] of map.held) fixed[variable] = value;
  return liesIn(study, run, { configuration: map.configuration, x: map.plane[0], y: map.plane[1], fixed });
}

function axisOf({ study }: Store, variable: number): { values: number[] } {
  const found = study.insight!.parts.flatMap(({ factors }) => factors).find((factor) => factor.variable === variable);
  const { low, high } = study.variables[variable]!;
  return found ?? { values: [low, high] };
}

function placeOf(store: Store, variable: number, value: number): number {
  return (
    placeAt(
      {
        ...axisOf(store, variable),
        title: "",
        unit: "",
        variable,
        levels: [],
        label: "",
        is_condition: false,
        labels: [],
      },
      value,
    ) *
    (TICKS - 1)
  );
}

function ticks(store: Store, map: ChanceMap, axis: 0 | 1): { title: string; unit: string; names: string[] } {
  const variable = store.study.variables[map.plane[axis]]!;
  const { values } = axisOf(store, map.plane[axis]);
  const names = Array.from({ length: TICKS }, (_, tick) => {
    const at = (tick / (TICKS - 1)) * (values.length - 1);
    return number(values[Math.round(at)]!, 3);
  });
  return { title: `${variable.title} [${variable.unit || "\u2013"}]`, unit: "", names };
}

function key(pen: Pen, { right, top, bottom }: Frame, colours: Palette): void {
  const steps = 40;
  const height = (bottom - top) / steps;
  for (let step = 0; step < steps; step++) {
    pen.fillStyle = shade(colours.ramp, 1 - step / (steps - 1));
    pen.fillRect(right + 10, top + step * height, 10, height + 0.6);
  }
  pen.strokeStyle = colours.muted;
  pen.lineWidth = 1;
  pen.strokeRect(right + 10, top, 10, bottom - top);
  pen.fillStyle = colours.ink;
  pen.font = `11px ${colours.font}`;
  pen.textAlign = "left";
  pen.textBaseline = "middle";
  pen.fillText("100", right + 24, top + 6);
  pen.fillText("50 %", right + 24, (top + bottom) / 2);
  pen.fillText("0", right + 24, bottom - 6);
}

function read(map: ChanceMap, across: number, up: number): string {
  if (!(across >= 0 && across <= 1 && up >= 0 && up <= 1)) return "\u00a0";
  const last = map.size - 1;
  const index = Math.round(up * last) * map.size + Math.round(across * last);
  return `Met with ${map.passing[index]}\u202f%, the likelier verdict is wrong with ${map.misjudged[index]}\u202f%.`;
}
