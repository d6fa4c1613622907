// The cockpit: constraint plot, or a table where there is no plane, with thresholds and waveforms beside it.
import { addTools, card, el } from "../dom";
import { createConfigurations } from "../panels/configurations";
import { createControls } from "../panels/controls";
import { IN_PRINT, quoted, savingMenu } from "../panels/export";
import { createSelected } from "../panels/selected";
import { createSummary } from "../panels/summary";
import { createTable } from "../panels/table";
import { createThresholds } from "../panels/thresholds";
import { createWaveforms, isKept } from "../panels/waveforms";
import { plotted } from "../plane/plane";
import { attachInteraction } from "../plot/interaction";
import { createPlot } from "../plot/plot";
import { partsIn } from "../plot/sheet";
import type { State, Store } from "../store";
import type { View } from "./view";

export const plotView: View = {
  name: "plot",
  title: "Cockpit",
  suits: () => true,
  create(store) {
    const { study } = store;
    const { box, reset } = createThresholds(store);
    const thresholds = study.requirements.length ? [addTools(card("requirements", "Requirements", box), reset)] : [];
    const selected = createSelected(store);
    const run = card("run", "Selected run", selected.box);
    run.querySelector("h2")!.append(selected.name);
    const waves = study.figures.length ? [wavesCard(store)] : [];
    const column = (name: string, ...cards: HTMLElement[]): HTMLElement => el("div", { class: name }, ...cards);
    const beside = [column("decide", ...thresholds, run), ...(waves.length ? [column("watch", ...waves)] : [])];
    if (plotted(study)) return column("cockpit", column("look", plotCard(store)), column("beside", ...beside));
    const title = study.variables.length ? "Runs" : "Configurations";
    const list = study.variables.length ? createTable(store) : createConfigurations(store);
    return column(
      "cockpit",
      column("look", card("overview", title, createSummary(store), list)),
      column("beside", ...beside),
    );
  },
};

function wavesCard(store: Store): HTMLElement {
  const { box: waveforms, pin, picture } = createWaveforms(store);
  const saved = {
    name: "waveforms",
    purpose: IN_PRINT,
    picture,
    command: () => {
      const run = store.state.selected;
      const number = run < 0 ? "RUN" : store.study.number[run]!;
      return isKept(store, run)
        ? `dse figure DIR --only waveforms --run ${number} --format svg`
        : `dse replay DIR ${number} --plot run-${number}.svg`;
    },
  };
  return addTools(card("waves", "Waveforms", waveforms), pin, savingMenu(store, saved));
}

const EXPLAINED: (keyof State)[] = ["configuration", "x", "y", "fixed", "selected"];

function plotCard(store: Store): HTMLElement {
  const plot = createPlot(store);
  const tools = attachInteraction(store, plot);
  const note = el("p", { class: "hint", id: "plane-note" });
  const explain = (): void => {
    const { on, beside } = plot.plane();
    const selected = store.points().first(store.state.selected);
    const away = store.state.selected >= 0 && !on.includes(selected) && !beside.includes(selected);
    const hint = away
      ? "The selected run is outside this plane."
      : `Click a ${store.points().noun}, or move with the arrow keys; with Shift a click pins and a drag brushes.`;
    note.textContent = `${plot.plane().note} ${hint}`;
  };
  const saved = {
    name: "constraint-plot",
    purpose: IN_PRINT,
    picture: () => partsIn(plot.surface),
    command: () => {
      const { study, state } = store;
      const configuration =
        study.configurations.length > 1
          ? ` --configuration ${quoted(study.configurations[state.configuration]!.id)}`
          : "";
      return `dse figure DIR --only constraints --x ${quoted(study.variables[state.x]!.name)} --y ${quoted(study.variables[state.y]!.name)}${configuration} --format svg`;
    },
  };
  explain();
  store.subscribe((_, changed) => {
    if (EXPLAINED.some((key) => changed.has(key))) explain();
  });
  return addTools(
    card("constraint", "Constraint plot", createControls(store), createSummary(store), plot.element, note),
    ...tools,
    savingMenu(store, saved),
  );
}
