// The waveforms of the selected run as in Figure 7 of the paper: target red and dashed, current blue.
import uPlot from "uplot";
import { el } from "../dom";
import { number, withUnit } from "../format";
import type { Numbers } from "../packing";
import type { Store } from "../store";
import { axisLabel, type Figure } from "../study";
import { palette } from "../theme";
import { decode } from "../waveform";

const HEIGHT = 210;

interface Chart {
  plot: uPlot;
  box: HTMLElement;
}

export function createWaveforms(store: Store): HTMLElement {
  const box = el("div", { class: "figures" });
  let charts: Chart[] = [];
  let drawn = 0;
  const draw = async (): Promise<void> => {
    const turn = ++drawn;
    const blocks = await store.study.waveforms();
    if (turn !== drawn) return;
    for (const { plot } of charts) plot.destroy();
    charts = [];
    const { selected } = store.state;
    const run = selected < 0 ? -1 : store.study.number[selected]!;
    box.dataset["run"] = String(run);
    const kept = store.study.figures.some((figure) => figure.row.has(run));
    box.replaceChildren(
      ...(kept
        ? store.study.figures.map((figure, index) =>
            figure.row.has(run) ? drawFigure(figure, index, run, blocks, charts) : missing(store, run, figure.title),
          )
        : [missing(store, run, "")]),
      ...(kept ? [el("p", { class: "hint" }, "Drag to zoom in time, double-click to see everything.")] : []),
    );
    for (const { plot, box: holder } of charts) plot.setSize({ width: holder.clientWidth, height: HEIGHT });
  };
  new ResizeObserver(() => {
    for (const { plot, box: holder } of charts) {
      if (holder.clientWidth && holder.clientWidth !== plot.width) plot.setSize({ width: holder.clientWidth, height: HEIGHT });
    }
  }).observe(box);
  store.subscribe((_, changed) => {
    if (changed.has("selected") || changed.has("theme")) void draw();
  });
  void draw();
  return box;
}

function missing(store: Store, run: number, title: string): HTMLElement {
  const { selected } = store.state;
  const failed = selected >= 0 && !store.study.done[selected];
  return el(
    "figure",
    { class: "missing" },
    title && el("figcaption", {}, el("b", {}, title)),
    el(
      "p",
      {},
      run < 0
        ? "Select a run to see its waveform."
        : failed
          ? `Run ${run} failed and left no waveform. To see it fail again, with DIR the study's folder:`
          : `${title ? "The waveform" : "The waveforms"} of run ${run} ${title ? "was" : "were"} not kept. To simulate the run again, bit for bit, with DIR the study's folder:`,
    ),
    run >= 0 && el("code", {}, `dse replay DIR ${run}`),
  );
}

function drawFigure(figure: Figure, index: number, run: number, blocks: Map<string, Numbers>, charts: Chart[]): HTMLElement {
  const colours = palette();
  const { time } = figure;
  const current = decode(figure, index, run, "current", blocks)!;
  const target = decode(figure, index, run, "target", blocks);
  const reading = el("span", { class: "reading" });
  const holder = el("div", { class: "chart", role: "img", "aria-label": description(figure, run, current) });
  const read = (at: number): void => {
    const parts = [`t = ${withUnit(number(time[at]!, 4), "s")}`, `${figure.current} ${withUnit(number(current[at] ?? NaN), figure.unit)}`];
    if (target) parts.push(`${figure.target} ${withUnit(number(target[at] ?? NaN), figure.unit)}`);
    reading.textContent = parts.join("   ");
  };
  read(time.length - 1);
  const axis = { stroke: colours.ink, font: `12px ${colours.font}`, labelFont: `600 12px ${colours.font}`, labelSize: 20 };
  const lines = { grid: { stroke: colours.line, width: 1 }, ticks: { stroke: colours.line, width: 1, size: 5 } };
  const plot = new uPlot(
    {
      width: 480,
      height: HEIGHT,
      legend: { show: false },
      padding: [8, 14, 0, 0],
      scales: { x: { time: false }, y: { range: padded } },
      cursor: { sync: { key: "time" }, points: { size: 6 }, y: false },
      axes: [
        { ...axis, ...lines, label: "time [s]", size: 34, values: (_, ticks) => ticks.map((tick) => number(tick, 6)) },
        { ...axis, ...lines, label: axisLabel({ title: figure.current, unit: figure.unit }), size: 52, values: (_, ticks) => ticks.map((tick) => number(tick, 6)) },
      ],
      series: [
        {},
        { label: figure.current, stroke: colours.current, width: 2, points: { show: false } },
        ...(target ? [{ label: figure.target, stroke: colours.target, width: 1.6, dash: [7, 5], points: { show: false } }] : []),
      ],
      hooks: { setCursor: [(self: uPlot) => read(self.cursor.idx ?? time.length - 1)] },
    },
    [time, current, ...(target ? [target] : [])] as uPlot.AlignedData,
    holder,
  );
  charts.push({ plot, box: holder });
  return el(
    "figure",
    {},
    el(
      "figcaption",
      {},
      el("b", {}, figure.title),
      target && el("span", { class: "key target" }, figure.target),
      el("span", { class: "key current" }, figure.current),
      reading,
    ),
    holder,
  );
}

function padded(_: uPlot, low: number | null, high: number | null): [number, number] {
  if (low === null || high === null) return [0, 1];
  const room = 0.07 * (high - low) || Math.max(0.5, 0.1 * Math.abs(high));
  return [low - room, high + room];
}

function description(figure: Figure, run: number, current: ArrayLike<number | null>): string {
  const known = Array.from(current).filter((value): value is number => value !== null);
  const low = known.reduce((a, b) => Math.min(a, b), Infinity);
  const high = known.reduce((a, b) => Math.max(a, b), -Infinity);
  return `${figure.title} of run ${run}: from ${number(low)} to ${number(high)}, ends at ${withUnit(number(known.at(-1) ?? NaN), figure.unit)}`;
}
