// The cockpit: constraint plot, or a table where there is no plane, with thresholds and waveforms beside it.
import { card, el } from "../dom";
import { createConfigurations } from "../panels/configurations";
import { createControls } from "../panels/controls";
import { createSelected } from "../panels/selected";
import { createSummary } from "../panels/summary";
import { createTable } from "../panels/table";
import { createThresholds } from "../panels/thresholds";
import { createWaveforms } from "../panels/waveforms";
import { plotted } from "../plane/plane";
import { attachInteraction } from "../plot/interact";
import { createPlot } from "../plot/plot";
import type { Store } from "../store";
import type { View } from "./view";

export const plotView: View = {
  name: "plot",
  title: "Constraint plot",
  suits: () => true,
  create(store) {
    const { study } = store;
    const thresholds = study.requirements.length ? [card("requirements", "Thresholds", createThresholds(store))] : [];
    const run = card("run", "Selected run", createSelected(store));
    const waves = study.figures.length ? [card("waves", "Waveforms", createWaveforms(store))] : [];
    const column = (name: string, ...cards: HTMLElement[]): HTMLElement => el("div", { class: name }, ...cards);
    if (plotted(study)) return column("columns", column("left", plotCard(store), ...thresholds), column("right", run, ...waves));
    const title = study.variables.length ? "Runs" : "Configurations";
    const list = study.variables.length ? createTable(store) : createConfigurations(store);
    return column("columns", column("wide", card("overview", title, createSummary(store), list)), column("left", run, ...thresholds), column("right", ...waves));
  },
};

function plotCard(store: Store): HTMLElement {
  const plot = createPlot(store);
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
