// The waveforms of the run under the pointer, else of the selected one, as in Figure 7 of the paper (target red and
// dashed, current blue), with the pinned runs over them.
import uPlot from "uplot";
import { togglePin } from "../actions";
import type { Chart as DrawnChart } from "../chart";
import { el } from "../dom";
import { number, withUnit } from "../format";
import type { Numbers } from "../packing";
import { paintChart } from "../plot/chart";
import { lineEntry } from "../plot/legend";
import type { Part } from "../plot/sheet";
import { MOST_PINS, type State, type Store } from "../store";
import { axisLabel, type Figure } from "../study";
import { palette } from "../theme";
import { decode } from "../waveform";

type Line = (number | null)[] | Float64Array;

interface Chart {
  plot: uPlot;
  holder: HTMLElement;
  figure: Figure;
  index: number;
  reading: HTMLElement;
}

const SHOWN: (keyof State)[] = ["selected", "hovered", "pins"];

/** The charts, and the button that pins the selected run. */
export function createWaveforms(store: Store): { box: HTMLElement; pin: HTMLElement; picture: () => Part[] } {
  const notice = el("div", { class: "missing" });
  const legend = el("div", { class: "curves" }, el("span", { class: "keys" }), el("span", { class: "keys" }));
  const figures = el("div", { class: "figures" });
  const pin = el("button", { id: "pin", type: "button", click: () => togglePin(store, store.state.selected) });
  const box = el("div", { class: "waveforms" }, legend, notice, figures);
  let blocks: Map<string, Numbers> | null = null;
  let charts: Chart[] = [];

  const show = (): void => {
    drawLegend(store, legend);
    drawPin(store, pin);
    if (!blocks) return;
    const run = runShown(store);
    const drawn = [run, ...store.state.pins].some((each) => isKept(store, each));
    figures.hidden = !drawn;
    notice.replaceChildren(...(isKept(store, run) ? [] : [missing(store, run)]));
    if (!charts.length && drawn)
      charts = store.study.figures.map((figure, index) => createChart(figure, index, figures));
    for (const chart of charts) update(store, chart, run, blocks);
    figures.dataset.run = String(run < 0 ? -1 : store.study.number[run]!);
  };
  store.subscribe((_, changed) => {
    if (SHOWN.some((key) => changed.has(key))) show();
    if (changed.has("theme")) {
      drawLegend(store, legend);
      for (const { plot } of charts) plot.redraw(false, true);
    }
  });
  show();
  void store.study.waveforms().then((unpacked) => {
    blocks = unpacked;
    show();
  });
  return { box, pin, picture: () => (figures.hidden ? [] : charts.map((chart) => partOfChart(store, chart))) };
}

/** A chart as it is shown, for a picture that is saved. */
function partOfChart(store: Store, { plot, holder, figure }: Chart): Part {
  const { study, state } = store;
  const axis = (key: string): [number, number] => [plot.scales[key]!.min ?? 0, plot.scales[key]!.max ?? 1];
  const [[left, right], [low, high]] = [axis("x"), axis("y")];
  const looks = linesOf(plot);
  const run = runShown(store);
  const names = [
    ...Array.from({ length: MOST_PINS }, (_, pin) => `Run ${study.number[state.pins[pin] ?? -1]}`),
    `Run ${study.number[run]}`,
  ];
  const known = looks.map(({ values }) => Array.from(values).some((value) => value !== null));
  const legend = names.flatMap((name, index) =>
    known[2 * index] ? [lineEntry(name, looks[2 * index]!.look.colour)] : [],
  );
  if (known.at(-1))
    legend.push(lineEntry(figure.target || "target", looks.at(-1)!.look.colour, looks.at(-1)!.look.dash));
  const chart: DrawnChart = {
    name: figure.name,
    title: figure.title,
    note: "",
    x: { title: "time", unit: "s", log: false, low: left, high: right, names: [] },
    y: { title: figure.current || figure.title, unit: figure.unit, log: false, low, high, names: [] },
    drawn: looks
      .filter((_, index) => known[index])
      .map(({ values, look }) => ({
        kind: "line",
        label: "",
        x: figure.time,
        y: Float64Array.from(values, (value) => value ?? NaN),
        look,
      })),
  };
  return {
    title: figure.title,
    width: holder.clientWidth,
    height: holder.clientHeight,
    legend,
    paint: (sheet) => void paintChart(sheet, chart, palette()),
  };
}

function linesOf({
  data,
  series,
}: uPlot): { values: ArrayLike<number | null | undefined>; look: { colour: string; width: number; dash: number[] } }[] {
  return data.slice(1).map((values, index) => {
    const { stroke, width, dash } = series[index + 1]!;
    return {
      values,
      look: {
        colour: String(typeof stroke === "function" ? stroke(null as never, index + 1) : stroke),
        width: width ?? 1,
        dash: dash ?? [],
      },
    };
  });
}

function runShown(store: Store): number {
  const { hovered, selected } = store.state;
  return isKept(store, hovered) ? hovered : selected;
}

/** Whether the page has a waveform of the run. */
export function isKept({ study }: Pick<Store, "study">, run: number): boolean {
  return run >= 0 && study.figures.some(({ row }) => row.has(study.number[run]!));
}

function drawLegend(store: Store, box: HTMLElement): void {
  const { study, state } = store;
  const [now, pinned] = [...box.children] as [HTMLElement, HTMLElement];
  const run = runShown(store);
  const colours = palette();
  const focused =
    document.activeElement instanceof HTMLElement && box.contains(document.activeElement)
      ? document.activeElement.id
      : "";
  const key = (colour: string): HTMLElement => {
    const line = el("span", { class: "stroke", "aria-hidden": "true" });
    line.style.borderColor = colour;
    return line;
  };
  const parts: HTMLElement[] = [];
  if (run >= 0)
    parts.push(
      el(
        "span",
        { class: "entry-key" },
        key(colours.current),
        el("b", {}, `Run ${study.number[run]}`),
        el("span", { class: "muted" }, run === state.selected ? "selected" : "under the pointer"),
      ),
    );
  if (study.figures.some(({ shape }) => shape !== "none")) {
    const dashed = key(colours.target);
    dashed.classList.add("dashed");
    parts.push(el("span", { class: "entry-key" }, dashed, el("span", { class: "muted" }, "target")));
  }
  now.replaceChildren(...parts);
  // A button that is made anew while it is pressed, as the pointer leaves the plot, is not clicked.
  const drawn = [...state.pins, ...colours.pins].join();
  if (pinned.dataset.drawn === drawn) return;
  pinned.dataset.drawn = drawn;
  const pins = state.pins.map((pin, index) => {
    const name = `Run ${study.number[pin]}`;
    const unpin = el(
      "button",
      {
        id: `unpin-${index}`,
        class: "bare",
        type: "button",
        title: `Unpin ${name}`,
        "aria-label": `Unpin ${name}`,
        click: () => togglePin(store, pin),
      },
      "\u00d7",
    );
    return el("span", { class: "entry-key pin" }, key(colours.pins[index]!), el("b", {}, name), unpin);
  });
  pinned.replaceChildren(...pins);
  if (focused) (document.getElementById(focused) ?? document.getElementById("pin"))?.focus();
}

function drawPin({ state }: Store, pin: HTMLButtonElement): void {
  const pinned = state.pins.includes(state.selected);
  const full = !pinned && state.pins.length >= MOST_PINS;
  pin.textContent = pinned ? "Unpin selected" : "Pin selected";
  pin.setAttribute("aria-pressed", String(pinned));
  pin.disabled = state.selected < 0 || full;
  pin.title = full
    ? `${MOST_PINS} runs are pinned: unpin one first`
    : "Key P on the plot, or a click with Shift, pins, too";
}

function missing({ study }: Store, run: number): HTMLElement {
  if (run < 0) return el("p", {}, "Select a run to see its waveform.");
  const which = study.number[run]!;
  const text = study.done[run]
    ? `The waveforms of run ${which} were not kept. To simulate the run again, bit for bit, with DIR the study\u2019s folder:`
    : `Run ${which} failed and left no waveform. To see it fail again, with DIR the study\u2019s folder:`;
  return el("div", {}, el("p", {}, text), el("code", {}, `dse replay DIR ${which}`));
}

function createChart(figure: Figure, index: number, box: HTMLElement): Chart {
  const reading = el("span", { class: "reading" });
  const holder = el("div", { class: "chart", role: "img" });
  box.append(
    el(
      "figure",
      {},
      el(
        "figcaption",
        {},
        el("b", { title: figure.target ? `${figure.current}, ${figure.target}` : figure.current }, figure.title),
        reading,
      ),
      holder,
    ),
  );
  // Colours are asked for at every repaint, so that a change of theme needs no new chart.
  const ink = (): string => palette().ink;
  const line = (): string => palette().line;
  const axis = {
    stroke: ink,
    font: `12px ${palette().font}`,
    labelFont: `600 12px ${palette().font}`,
    labelSize: 18,
    grid: { stroke: line, width: 1 },
    ticks: { stroke: line, width: 1, size: 5 },
    values: (_: uPlot, ticks: number[]) => ticks.map((tick) => number(tick, 6)),
  };
  // uPlot would round every point to a pixel, and a smooth line to a staircase.
  const series = (stroke: () => string, width: number, dash?: number[]): uPlot.Series => ({
    stroke,
    width,
    pxAlign: 0,
    points: { show: false },
    ...(dash ? { dash } : {}),
  });
  const plot = new uPlot(
    {
      width: holder.clientWidth || 480,
      height: holder.clientHeight || 180,
      pxAlign: 0,
      legend: { show: false },
      padding: [8, 22, 0, 0],
      scales: { x: { time: false }, y: { range: padded } },
      cursor: { sync: { key: "time" }, points: { size: 6 }, y: false },
      axes: [
        { ...axis, label: "time [s]", size: 30 },
        { ...axis, label: axisLabel({ title: "", unit: figure.unit }).trim(), size: 50 },
      ],
      series: [
        {},
        ...Array.from({ length: MOST_PINS }, (_, pin) => [
          series(() => palette().pins[pin]!, 1.6),
          series(() => palette().pins[pin]!, 1.2, [3, 4]),
        ]).flat(),
        series(() => palette().current, 2),
        series(() => palette().target, 1.6, [7, 5]),
      ],
      hooks: { setCursor: [(self: uPlot) => read(self, figure, reading)] },
    },
    [[]],
    holder,
  );
  new ResizeObserver(() => {
    if (holder.clientWidth) plot.setSize({ width: holder.clientWidth, height: holder.clientHeight });
  }).observe(holder);
  return { plot, holder, figure, index, reading };
}

function update(
  { study, state }: Store,
  { plot, holder, figure, index, reading }: Chart,
  run: number,
  blocks: Map<string, Numbers>,
): void {
  const nothing = new Array<null>(figure.time.length).fill(null);
  const linesOf = (each: number): [Line, Line] => {
    const which = each < 0 ? -1 : study.number[each]!;
    return [
      decode(figure, index, which, "current", blocks) ?? nothing,
      decode(figure, index, which, "target", blocks) ?? nothing,
    ];
  };
  const pins = Array.from({ length: MOST_PINS }, (_, pin) => linesOf(state.pins[pin] ?? -1)).flat();
  const shown = linesOf(run);
  const { min, max } = plot.scales.x!;
  const fresh = min === undefined || min === null || min === max;
  plot.setData([figure.time, ...pins, ...shown] as uPlot.AlignedData, fresh);
  // What was zoomed to stays; setting it anew fits the other axis.
  if (!fresh) plot.setScale("x", { min: min!, max: max! });
  holder.setAttribute("aria-label", description(figure, run < 0 ? -1 : study.number[run]!, shown[0]));
  read(plot, figure, reading);
}

function read({ data, cursor }: uPlot, figure: Figure, reading: HTMLElement): void {
  const at = cursor.idx ?? figure.time.length - 1;
  const [current, target] = [data.at(-2)?.[at], data.at(-1)?.[at]] as (number | null | undefined)[];
  if (current === null || current === undefined || data.length < 3) {
    reading.textContent = "";
    return;
  }
  const parts = [`t = ${withUnit(number(figure.time[at]!, 4), "s")}`, withUnit(number(current), figure.unit)];
  if (target !== null && target !== undefined) parts.push(`target ${withUnit(number(target), figure.unit)}`);
  reading.textContent = parts.join("   ");
}

function padded(_: uPlot, low: number | null, high: number | null): [number, number] {
  if (low === null || high === null) return [0, 1];
  const room = 0.07 * (high - low) || Math.max(0.5, 0.1 * Math.abs(high));
  return [low - room, high + room];
}

function description(figure: Figure, run: number, current: Line): string {
  const known = Array.from(current as ArrayLike<number | null>).filter((value): value is number => value !== null);
  if (!known.length) return `${figure.title}: no waveform of run ${run}`;
  const low = known.reduce((a, b) => Math.min(a, b), Infinity);
  const high = known.reduce((a, b) => Math.max(a, b), -Infinity);
  return `${figure.title} of run ${run}: from ${number(low)} to ${number(high)}, ends at ${withUnit(number(known.at(-1) ?? NaN), figure.unit)}`;
}
