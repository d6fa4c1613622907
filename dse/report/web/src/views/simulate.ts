// Runs that the page makes itself: a slider for everything, and waveforms, verdicts and the constraint plot follow.
import { addTools, card, choose, el, field } from "../dom";
import { group, number, withUnit } from "../format";
import { copyParts } from "../panels/copy";
import { attachInteraction } from "../plot/interaction";
import { createPlot, type Plot } from "../plot/plot";
import { canSimulate, readSimulation, type SimulationDocument } from "../simulate/document";
import type { Ran } from "../simulate/engine";
import { type Axis, coarseFirst, gridStudy, LEVELS, valueAt } from "../simulate/grid";
import { createPool, type Pool } from "../simulate/pool";
import { type Control, controlsOf, createSliders, type Sliders } from "../simulate/sliders";
import { createTrace } from "../simulate/traces";
import { createVerdicts } from "../simulate/verdicts";
import { createStore, type State, type Store } from "../store";
import { simulatedStudy } from "../yaml";
import type { View } from "./view";

/** The condition that tells the bench of a run. */
const BENCH = "testbench";

export const simulateView: View = {
  name: "simulate",
  title: "Simulate",
  suits: canSimulate,
  create(store) {
    const box = el("div", { class: "cockpit simulating" }, el("p", { class: "muted" }, "compiling \u2026"));
    readSimulation().then(
      ({ document, module, worker }) => fill(box, store, document, createPool(worker, document, module)),
      (error) => box.replaceChildren(el("p", { class: "card problem" }, `This page cannot simulate here: ${error}`)),
    );
    return box;
  },
};

function fill(box: HTMLElement, store: Store, document: SimulationDocument, pool: Pool): void {
  const { study } = store;
  const order = coarseFirst();
  let system = 0;
  let draw = 0;
  let controls: Control[] = [];
  let values = new Float64Array();
  let axes: [Control, Control] | null = null;
  let sliders: Sliders;
  let last: Ran | null = null;
  let before: Ran | null = null;
  let plane: { plot: Plot; study: ReturnType<typeof gridStudy>; store: Store; axes: [Axis, Axis] } | null = null;

  const note = el("p", { class: "hint", id: "simulated-note", role: "status" });
  const head = el("div", { class: "row" });
  const top = el("div", { class: "controls" }, head);
  const holder = el("div", { class: "plane" });
  const cross = el("div", { class: "picked", "aria-hidden": "true", hidden: true });
  const sliderBox = el("div");
  const verdicts = createVerdicts(store);
  const charts = document.figures.map((figure) => createTrace(figure, "of the run simulated here"));
  const problem = el("p", { class: "problem", hidden: true });
  const restart = el(
    "button",
    { type: "button", id: "from-selected", title: "Everything back to the selected run", click: () => begin() },
    "Start from the selected run",
  );
  const copied = copyParts("next-study", "The plane as the next study", "Copy as a study", () => nextStudy());
  const settings = addTools(card("settings", "Parameters", sliderBox), restart);
  const column = (name: string, ...cards: HTMLElement[]): HTMLElement => el("div", { class: name }, ...cards);
  const waves = el("div", { class: "figures" }, ...charts.map(({ element }) => element));
  box.replaceChildren(
    column(
      "look",
      card(
        "simulated-plane",
        "Constraint plot, simulated here",
        top,
        holder,
        note,
        el("div", { class: "folds" }, ...copied),
      ),
    ),
    column(
      "beside",
      column("decide", settings, card("simulated-run", "Run simulated here", problem, verdicts.element, waves)),
    ),
  );

  // ---- where it starts ----

  const begin = (): void => {
    const run = Math.max(0, store.state.selected);
    const configuration = study.size ? study.configuration[run]! : 0;
    const benches = study.variables.find(({ name }) => name === BENCH)?.values;
    takeSystem(systemOf(configuration, benches?.[run] ?? 0), new Map(runValues(run)));
  };
  const systemOf = (configuration: number, bench: number): number => {
    const found = document.systems.findIndex((each) => each.configuration === configuration && each.bench === bench);
    return Math.max(0, found);
  };
  const runValues = (run: number): [string, number][] =>
    study.variables.map((variable, index) => {
      const { factor, offset } = document.variables[index]!;
      return [variable.name, variable.values[run]! * factor + offset];
    });
  /** Another system, with what is *known* of its settings by name (SI). */
  const takeSystem = (chosen: number, known: ReadonlyMap<string, number>): void => {
    system = chosen;
    const entries = document.systems[system]!.settings;
    values = Float64Array.from(entries, ([at, , value]) => known.get(document.settings[at]!.name) ?? value);
    controls = controlsOf(document, system);
    const numbers = controls.filter(({ setting }) => setting.kind === "real");
    const wanted =
      axes?.map(({ setting }) => setting.name) ?? [store.state.x, store.state.y].map((at) => study.variables[at]?.name);
    const kept = wanted.map((name) => numbers.find(({ setting }) => setting.name === name));
    const [x, y] = [kept[0] ?? numbers[0], kept[1] ?? numbers.find((each) => each !== (kept[0] ?? numbers[0]))];
    axes = x && y ? [x, y] : null;
    sliders = createSliders(controls, values.slice(), move);
    sliderBox.replaceChildren(sliders.element);
    before = null;
    drawHead(numbers);
    renew();
  };
  const drawHead = (numbers: Control[]): void => {
    const parts: HTMLElement[] = [];
    const options = numbers.map(({ title, unit, place }): [string, string] => [
      String(place),
      `${title} [${unit || "\u2013"}]`,
    ]);
    const axis = (which: 0 | 1, text: string): void => {
      const select = choose(options, String(axes![which].place), (value) => {
        const one = numbers.find(({ place }) => place === Number(value))!;
        const other = axes![1 - which]!;
        axes = one === other ? [axes![1], axes![0]] : which ? [other, one] : [one, other];
        drawHead(numbers);
        renew();
      });
      select.id = which ? "simulated-y" : "simulated-x";
      parts.push(field(text, select));
    };
    if (axes) {
      axis(0, "Horizontal");
      axis(1, "Vertical");
    }
    const { configuration, bench } = document.systems[system]!;
    const known = byName(controls, values);
    const pick = (id: string, text: string, labels: string[], now: number, chosen: (value: number) => void): void => {
      if (labels.length < 2) return;
      const select = choose(
        labels.map((label, value): [string, string] => [String(value), label]),
        String(now),
        (value) => chosen(Number(value)),
      );
      select.id = id;
      parts.push(field(text, select));
    };
    const ids = study.configurations.map(({ id }) => id);
    pick("simulated-configuration", "Configuration", ids, configuration, (value) =>
      takeSystem(systemOf(value, bench), known),
    );
    pick("simulated-bench", "Test bench", document.benches, bench, (value) =>
      takeSystem(systemOf(configuration, value), known),
    );
    const draws = Array.from({ length: document.draws }, (_, place) => `draw ${place + 1}`);
    pick("simulated-draw", "Noise", draws, draw, (value) => {
      draw = value;
      renew();
    });
    head.replaceChildren(...parts);
  };

  // ---- what is simulated ----

  const move = (place: number, si: number): void => {
    if (values[place] === si) return;
    values = values.slice();
    values[place] = si;
    sliders.show(values);
    if (axes?.some((axis) => axis.place === place)) simulate();
    else renew();
  };
  const simulate = (): void => {
    const started = performance.now();
    pool.now({ system, draw, values, traces: true }, (ran) => {
      performance.measure("simulated", { start: started, end: performance.now() });
      last = ran;
      before ??= ran;
      showRun();
    });
    placeCross();
  };
  const renew = (): void => {
    simulate();
    if (!axes) return;
    const shownAxes = axes.map(
      ({ setting, title, unit, low, high }): Axis => ({ name: setting.name, title, unit, low, high }),
    ) as [Axis, Axis];
    const here = axes;
    const points = order.nodes.map((node) => {
      const at = values.slice();
      const levels = [node % LEVELS, Math.floor(node / LEVELS)];
      here.forEach(({ place, factor, offset }, which) => {
        at[place] = valueAt(shownAxes[which]!, levels[which]!) * factor + offset;
      });
      return { system, draw, values: at, traces: false };
    });
    const runs: (Ran | null)[] = new Array(LEVELS * LEVELS).fill(null);
    const started = performance.now();
    let made = 0;
    let drawn = 0;
    pool.instead(points, (ran, place) => {
      runs[order.nodes[place]!] = ran;
      made++;
      const seconds = (performance.now() - started) / 1000;
      note.textContent =
        made < points.length
          ? `Simulated here: ${group(made)} of ${group(points.length)} runs \u2026`
          : `${group(made)} runs simulated here in ${withUnit(number(seconds, 2), "s")}; they are not stored. Click a place to simulate it.`;
      note.dataset.made = String(made);
      // Several workers do not answer in turn.
      const next = order.stages[drawn];
      if (!next || made < next.size || !order.nodes.slice(0, next.size).every((node) => runs[node])) return;
      drawn++;
      drawPlane(gridStudy(study, shownAxes, runs, next.stride), shownAxes);
    });
  };

  // ---- what is shown ----

  const drawPlane = (made: ReturnType<typeof gridStudy>, of: [Axis, Axis]): void => {
    const isSame = plane?.axes.every((axis, which) => axis.name === of[which]!.name);
    const state: State = {
      ...store.state,
      configuration: 0,
      x: 0,
      y: 1,
      fixed: [of[0].low, of[1].low],
      fill: -1,
      selected: -1,
      hovered: -1,
      brushes: [],
      pins: [],
      zoom: isSame ? plane!.store.state.zoom : null,
    };
    const own = createStore(made, state);
    const plot = createPlot(own);
    const tools = attachInteraction(own, plot);
    plot.surface.append(cross);
    const [horizontal, vertical] = axes!;
    const pick = (x: number, y: number): void => {
      values = values.slice();
      values[horizontal.place] = x * horizontal.factor + horizontal.offset;
      values[vertical.place] = y * vertical.factor + vertical.offset;
      sliders.show(values);
      simulate();
    };
    plot.surface.addEventListener("pointed-at", (event) => {
      event.stopPropagation();
      const { x, y } = (event as CustomEvent<{ x: number; y: number }>).detail;
      pick(x, y);
    });
    own.subscribe(({ selected }, changed) => {
      if (changed.has("selected") && selected >= 0)
        pick(made.variables[0]!.values[selected]!, made.variables[1]!.values[selected]!);
      if (changed.has("zoom")) requestAnimationFrame(placeCross);
    });
    for (const tool of tools) tool.removeAttribute("id");
    plane = { plot, study: made, store: own, axes: of };
    holder.replaceChildren(el("div", { class: "zooming" }, ...tools.slice(1)), plot.element);
    requestAnimationFrame(placeCross);
  };
  const placeCross = (): void => {
    const frame = plane?.plot.frame();
    if (!frame || !axes) return;
    const [x, y] = axes.map(({ place, factor, offset }) => (values[place]! - offset) / factor) as [number, number];
    const [left, top] = [frame.x(x), frame.y(y)];
    cross.hidden = !(left >= frame.left && left <= frame.right && top >= frame.top && top <= frame.bottom);
    cross.style.left = `${left}px`;
    cross.style.top = `${top}px`;
  };
  new ResizeObserver(() => requestAnimationFrame(placeCross)).observe(holder);

  const showRun = (): void => {
    if (!last) return;
    problem.hidden = !last.problem;
    problem.textContent = last.problem && `The run failed: ${last.problem}`;
    waves.hidden = Boolean(last.problem);
    verdicts.show(last, before);
    if (last.problem) return;
    last.traces.forEach((trace, at) => charts[at]!.show(trace, before && before !== last ? before.traces[at] : null));
  };

  store.subscribe(({ thresholds, theme }, changed) => {
    if (!changed.has("thresholds") && !changed.has("theme")) return;
    plane?.store.set({ thresholds, theme });
    showRun();
  });

  const nextStudy = (): string => {
    const { configuration, bench } = document.systems[system]!;
    const told = controls.map((control) => ({
      ...control,
      name: control.setting.name,
      value: (values[control.place]! - control.offset) / control.factor,
      isMoved: values[control.place] !== document.systems[system]!.settings[control.place]![2],
      isAxis: Boolean(axes?.includes(control)),
    }));
    const id = study.configurations[configuration]!.id;
    return simulatedStudy(document.study, document.benches[bench]!, id, told);
  };
  begin();
}

function byName(controls: Control[], values: Float64Array): Map<string, number> {
  return new Map(controls.map(({ setting, place }) => [setting.name, values[place]!]));
}
