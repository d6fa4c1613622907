// The waveforms of compared designs on common axes: a colour a design, targets dashed.
import uPlot from "uplot";
import { choose, el, field } from "../../dom";
import { number, withUnit } from "../../format";
import { variablesOf } from "../../grouping";
import type { Numbers } from "../../packing";
import { axisLabel, type Figure } from "../../study";
import { palette } from "../../theme";
import { decode } from "../../waveform";
import { seriesColour } from "./colouring";
import { type Model, nameOf } from "./model";

const HEIGHT = 220;
const MOST_CASES = 60;

export function createOverlay(model: Model): HTMLElement {
  const { store } = model;
  const box = el("div", { class: "overlays" });
  const picker = el("div", { class: "row" });
  let plots: { plot: uPlot; holder: HTMLElement }[] = [];
  let turn = 0;
  const draw = async (): Promise<void> => {
    const mine = ++turn;
    const blocks = model.choices.picked.length ? await store.study.waveforms() : new Map<string, Numbers>();
    if (mine !== turn) return;
    for (const { plot } of plots) plot.destroy();
    plots = [];
    const runs = model.choices.picked.map((design) => runOf(model, design));
    box.dataset.runs = runs.map((run) => (run < 0 ? "" : store.study.number[run])).join(" ");
    picker.replaceChildren(...casePicker(model));
    box.replaceChildren(
      ...(runs.length
        ? store.study.figures.map((figure, index) => figureOf(model, figure, index, runs, blocks, plots))
        : []),
    );
    fit();
  };
  const fit = (): void => {
    for (const { plot, holder } of plots)
      if (holder.clientWidth && holder.clientWidth !== plot.width)
        plot.setSize({ width: holder.clientWidth, height: HEIGHT });
  };
  new ResizeObserver(fit).observe(box);
  model.subscribe((changed) => {
    const judged = (changed.has("demand") || changed.has("thresholds")) && model.choices.case < 0;
    if (changed.has("picked") || changed.has("case") || changed.has("theme") || judged) void draw();
  });
  void draw();
  return el("div", {}, picker, box);
}

/** Conditions and draws that runs were made at, by a run that has each. */
function casesOf({ store }: Model): { key: string; run: number }[] {
  const { study } = store;
  const columns = [...variablesOf(study, "condition"), ...variablesOf(study, "uncertain")];
  const found = new Map<string, number>();
  for (let run = 0; columns.length && run < study.size && found.size <= MOST_CASES; run++) {
    const key = columns.map(({ values }) => values[run]).join(" ");
    if (!found.has(key)) found.set(key, run);
  }
  return Array.from(found, ([key, run]) => ({ key, run }));
}

function casePicker(model: Model): HTMLElement[] {
  const { study } = model.store;
  const columns = [...variablesOf(study, "condition"), ...variablesOf(study, "uncertain")];
  const cases = casesOf(model);
  if (cases.length < 2 || cases.length > MOST_CASES) return [];
  const options = cases.map(({ run }): [string, string] => [
    String(run),
    columns.map(({ title, unit, values, text }) => `${title} ${withUnit(text(values[run]!), unit)}`).join(", "),
  ]);
  const select = choose([["-1", "the run that decides"], ...options], String(model.choices.case), (value) =>
    model.set({ case: Number(value) }),
  );
  return [field("Waveforms of", select)];
}

function runOf({ store, grouping, choices, standing }: Model, design: number): number {
  if (choices.case < 0) return standing().deciding[design]!;
  const columns = [...variablesOf(store.study, "condition"), ...variablesOf(store.study, "uncertain")];
  const runs = grouping.rows.subarray(grouping.start[design]!, grouping.start[design + 1]!);
  return runs.find((run) => columns.every(({ values }) => values[run] === values[choices.case])) ?? -1;
}

function figureOf(
  model: Model,
  figure: Figure,
  index: number,
  runs: number[],
  blocks: Map<string, Numbers>,
  plots: { plot: uPlot; holder: HTMLElement }[],
): HTMLElement {
  const { study } = model.store;
  const { picked } = model.choices;
  const colours = palette();
  const drawn = runs.flatMap((run, place) => {
    const number = run < 0 ? -1 : study.number[run]!;
    const current = decode(figure, index, number, "current", blocks);
    return current ? [{ place, number, current, target: decode(figure, index, number, "target", blocks) }] : [];
  });
  const lacking = picked
    .filter((_, place) => !drawn.some((one) => one.place === place))
    .map((design) => nameOf(model, design));
  const note = lacking.length
    ? el("p", { class: "hint" }, `No waveform was kept of the run of ${lacking.join(", ")}.`)
    : null;
  const caption = el("figcaption", {}, el("b", {}, figure.title));
  if (!drawn.length) return el("figure", {}, caption, note);
  // One target that is the same for all is drawn once.
  const targets = drawn.filter(({ target }) => target);
  const shared =
    targets.length > 1 &&
    targets.every(
      ({ target }) =>
        target!.length === targets[0]!.target!.length &&
        target!.every((value, at) => value === targets[0]!.target![at]),
    );
  const dashed = shared
    ? [{ ...targets[0]!, stroke: colours.target }]
    : targets.map((one) => ({ ...one, stroke: targets.length > 1 ? seriesColour(one.place) : colours.target }));
  const reading = el("span", { class: "reading" });
  const holder = el("div", {
    class: "lines",
    role: "img",
    "aria-label": `${figure.title} of ${drawn.map(({ place, number }) => `${nameOf(model, picked[place]!)} (run ${number})`).join(", ")}`,
  });
  const read = (at: number): void => {
    reading.textContent = [
      `t = ${withUnit(number(figure.time[at]!, 4), "s")}`,
      ...drawn.map(
        ({ place, current }) => `${nameOf(model, picked[place]!)} ${withUnit(number(current[at] ?? NaN), figure.unit)}`,
      ),
    ].join("   ");
  };
  read(figure.time.length - 1);
  const axis = {
    stroke: colours.ink,
    font: `12px ${colours.font}`,
    labelFont: `600 12px ${colours.font}`,
    labelSize: 20,
    grid: { stroke: colours.line, width: 1 },
    ticks: { stroke: colours.line, width: 1, size: 5 },
    values: (_: uPlot, ticks: number[]) => ticks.map((tick) => number(tick, 6)),
  };
  const plot = new uPlot(
    {
      width: 480,
      height: HEIGHT,
      legend: { show: false },
      padding: [8, 22, 0, 0],
      scales: { x: { time: false } },
      cursor: { sync: { key: "designs" }, points: { size: 6 }, y: false },
      axes: [
        { ...axis, label: "time [s]", size: 34 },
        { ...axis, label: axisLabel({ title: figure.current, unit: figure.unit }), size: 56 },
      ],
      series: [
        {},
        ...dashed.map(({ stroke }) => ({ stroke, width: 1.3, dash: [7, 5], points: { show: false } })),
        ...drawn.map(({ place }) => ({ stroke: seriesColour(place), width: 2, points: { show: false } })),
      ],
      hooks: { setCursor: [(self: uPlot) => read(self.cursor.idx ?? figure.time.length - 1)] },
    },
    [figure.time, ...dashed.map(({ target }) => target), ...drawn.map(({ current }) => current)] as uPlot.AlignedData,
    holder,
  );
  plots.push({ plot, holder });
  caption.append(...(targets.length ? [el("span", { class: "dashes" }, figure.target)] : []), reading);
  return el("figure", {}, caption, holder, note);
}
