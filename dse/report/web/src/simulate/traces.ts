// Waveforms of a run that is simulated now: charts that stay while what they show changes.
import uPlot from "uplot";
import { el } from "../dom";
import { number, withUnit } from "../format";
import { palette } from "../theme";

export interface TraceFigure {
  title: string;
  unit: string;
  current: string;
  target: string;
}

type Rows = Float64Array | (number | null)[];

export interface Lines {
  time: Rows;
  values: Rows;
  targets: Rows | null;
}

export interface TraceChart {
  element: HTMLElement;
  /** Needs the element to be in the page; *before* is drawn faintly behind it. */
  show(lines: Lines, before?: Lines | null): void;
}

const HEIGHT = 190;

export function createTrace(figure: TraceFigure, label: string): TraceChart {
  const holder = el("div", { class: "trace", role: "img", "aria-label": `${figure.title} ${label}` });
  const earlier = el("span", { class: "of before", hidden: true }, "at the start");
  const keys = [
    earlier,
    figure.target && el("span", { class: "of target" }, figure.target),
    el("span", { class: "of current" }, figure.current),
  ];
  const axisName = `${withUnit("", figure.unit).trim() || "\u2013"} over time [s]`;
  const caption = el("figcaption", {}, el("b", {}, figure.title), el("span", {}, axisName), ...keys);
  let plot: uPlot | null = null;
  return {
    element: el("figure", {}, caption, holder),
    show({ time, values, targets }, before) {
      if (!plot) {
        plot = createChart(holder);
        new ResizeObserver(() => {
          if (holder.clientWidth) plot!.setSize({ width: holder.clientWidth, height: HEIGHT });
        }).observe(holder);
      }
      earlier.hidden = !before;
      const nothing = Array.from({ length: time.length }, () => null);
      plot.setData([time, before?.values ?? nothing, values, targets ?? nothing] as uPlot.AlignedData);
    },
  };
}

function createChart(holder: HTMLElement): uPlot {
  // Colours are asked for at every repaint, so that a change of theme needs no new chart.
  const axis = {
    stroke: () => palette().ink,
    font: `12px ${palette().font}`,
    grid: { stroke: () => palette().line, width: 1 },
    ticks: { stroke: () => palette().line, width: 1, size: 5 },
    values: (_: uPlot, ticks: number[]): string[] => ticks.map((tick) => number(tick, 6)),
  };
  const line = (stroke: () => string, width: number, dash?: number[]): uPlot.Series => ({
    stroke,
    width,
    points: { show: false },
    ...(dash ? { dash } : {}),
  });
  return new uPlot(
    {
      width: holder.clientWidth,
      height: HEIGHT,
      legend: { show: false },
      cursor: { y: false, points: { size: 6 } },
      scales: { x: { time: false } },
      axes: [
        { ...axis, size: 30 },
        { ...axis, size: 52 },
      ],
      series: [
        {},
        line(() => palette().muted, 1.4),
        line(() => palette().current, 2),
        line(() => palette().target, 1.6, [7, 5]),
      ],
    },
    [[], [], [], []],
    holder,
  );
}
