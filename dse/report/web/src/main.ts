// Puts the page together.
import { startingRun } from "./actions";
import { createAnnouncement } from "./announce";
import { card, el } from "./dom";
import { count } from "./format";
import { startLive } from "./live";
import { createCharts } from "./panels/charts";
import { createConfigurations } from "./panels/configurations";
import { createControls } from "./panels/controls";
import { createFacts } from "./panels/facts";
import { createParallel } from "./panels/parallel";
import { createSelected } from "./panels/selected";
import { createSummary } from "./panels/summary";
import { createTable } from "./panels/table";
import { createThresholds } from "./panels/thresholds";
import { createWaveforms } from "./panels/waveforms";
import { createPlanes, startingPoint } from "./plane/plane";
import { attachInteraction } from "./plot/interact";
import { createPlot } from "./plot/plot";
import { createStore, studyThresholds, type State, type Store } from "./store";
import { readStudy, type Study } from "./study";
import { followTheme, startTheme } from "./theme";

async function start(): Promise<void> {
  const page = document.getElementById("page")!;
  const theme = startTheme();
  try {
    const study = await readStudy();
    const store = createStore(study, initial(study, theme));
    const planes = createPlanes(study);
    const plotted = study.variables.length >= 2;
    const selected = startingRun(store, plotted ? candidates(study, planes(store.state)) : study.number.keys());
    store.set({ selected, configuration: selected < 0 ? 0 : study.configuration[selected]! });
    page.replaceChildren(header(store), ...sections(store, plotted ? planes : null), createAnnouncement(store));
    startLive(store);
    document.documentElement.dataset["ready"] = "yes";
  } catch (error) {
    const hint = "DecompressionStream" in window ? "" : " This browser is too old: it cannot unpack the data (DecompressionStream).";
    page.replaceChildren(el("p", { class: "card problem" }, `The report cannot be shown: ${String(error)}.${hint}`));
    throw error;
  }
}

function initial(study: Study, theme: State["theme"]): State {
  const [x, y] = study.slices[0] ?? [0, 1];
  return {
    configuration: study.size ? study.configuration[0]! : 0,
    x: x!,
    y: y!,
    fixed: startingPoint(study),
    thresholds: studyThresholds(study),
    fill: -1,
    selected: -1,
    filter: "all",
    sort: { column: "run", descending: false },
    theme,
  };
}

function candidates(study: Study, plane: { on: Int32Array; beside: Int32Array }): Iterable<number> {
  return study.sampler === "scattered" ? plane.beside.length ? plane.beside : plane.on : plane.on;
}

function header(store: Store): HTMLElement {
  const { study } = store;
  const theme = followTheme(store);
  const parts = [count(study.size, "run")];
  if (study.configurations.length > 1) parts.push(count(study.configurations.length, "configuration"));
  if (study.variables.length) parts.push(count(study.variables.length, "design variable"));
  parts.push(count(study.requirements.length, "requirement"));
  const button = el("button", { id: "theme", type: "button", click: theme.toggle }, "");
  const name = (): void => {
    button.textContent = store.state.theme === "dark" ? "Light mode" : "Dark mode";
  };
  name();
  store.subscribe(name);
  return el("header", {}, el("h1", {}, study.title), el("span", { class: "muted" }, parts.join(" \u00b7 ")), el("span", { class: "spring" }), button);
}

function sections(store: Store, planes: ReturnType<typeof createPlanes> | null): HTMLElement[] {
  const { study } = store;
  const thresholds = study.requirements.length ? [card("requirements", "Thresholds", createThresholds(store))] : [];
  const run = card("run", "Selected run", createSelected(store));
  const waves = study.figures.length ? [card("waves", "Waveforms", createWaveforms(store))] : [];
  const charts = study.charted.length ? [card("charts", "Figures", createCharts(store))] : [];
  const column = (name: string, ...cards: HTMLElement[]): HTMLElement => el("div", { class: name }, ...cards);
  if (!planes) {
    const overview = card("overview", study.variables.length ? "Runs" : "Configurations", createSummary(store), listing(store));
    return [
      el("main", {}, column("wide", overview), column("left", run, ...thresholds), column("right", ...waves), column("wide", ...charts, createFacts(study))),
    ];
  }
  const configurations = study.configurations.length > 1 ? [card("overview", "Configurations", createConfigurations(store))] : [];
  return [
    el(
      "main",
      {},
      column("left", plotCard(store, planes), ...thresholds),
      column("right", run, ...waves),
      column("wide", ...configurations, card("all", "All runs", createParallel(store), createTable(store)), ...charts, createFacts(study)),
    ),
  ];
}

function listing(store: Store): HTMLElement {
  return store.study.variables.length ? createTable(store) : createConfigurations(store);
}

function plotCard(store: Store, planes: ReturnType<typeof createPlanes>): HTMLElement {
  const plot = createPlot(store, planes);
  attachInteraction(store, plot);
  const note = el("p", { class: "hint", id: "plane-note" });
  const explain = (): void => {
    const { on, beside } = plot.plane();
    const { selected } = store.state;
    const away = selected >= 0 && !on.includes(selected) && !beside.includes(selected);
    const hint = away ? "The selected run lies outside this plane." : "Click a run, or move with the arrow keys.";
    note.textContent = `${plot.plane().note} ${hint}`;
  };
  explain();
  store.subscribe(explain);
  return card("constraint", "Constraint plot", createControls(store), createSummary(store), plot.element, note);
}

void start();
