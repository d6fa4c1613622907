// Puts the page together.
import { followAddress, readFragment } from "./address";
import { startingRun } from "./actions";
import { createAnnouncement } from "./announce";
import { shownRuns } from "./counts";
import { el } from "./dom";
import { count } from "./format";
import { startLive } from "./live";
import { createBrushes } from "./panels/brushes";
import { startingPoint } from "./plane/plane";
import { createStore, studyThresholds, whileShown, type State, type Store } from "./store";
import { readStudy, type Study } from "./study";
import { followTheme, startTheme } from "./theme";
import { VIEWS } from "./views/views";

async function start(): Promise<void> {
  const page = document.getElementById("page")!;
  const theme = startTheme();
  try {
    const study = await readStudy();
    const store = createStore(study, initial(study, theme));
    const selected = startingRun(store, shownRuns(store) ?? study.number.keys());
    store.set({ selected, configuration: selected < 0 ? 0 : study.configuration[selected]! });
    const start = store.state;
    store.set(readFragment(study, location.hash.slice(1), start));
    page.replaceChildren(header(store), ...createViews(store), createAnnouncement(store));
    followAddress(store, start);
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
    brushes: [],
    pins: [],
    hovered: -1,
    zoom: null,
    settings: {},
    view: VIEWS.find((view) => view.suits(study))!.name,
    theme,
  };
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
  return el("header", {}, el("h1", { title: study.title }, study.title), el("span", { class: "muted" }, parts.join(" \u00b7 ")), el("span", { class: "spring" }), button);
}

/** Tabs, and below them the open view; a view is made when it is first opened. */
function createViews(store: Store): HTMLElement[] {
  const suited = VIEWS.filter((view) => view.suits(store.study));
  const made = new Map<string, { body: HTMLElement; show: () => void; hide: () => void }>();
  let shown: { hide: () => void } | null = null;
  const panel = el("div", { id: "view", role: "tabpanel", tabindex: -1 });
  const tabs = suited.map((view) => el("button", { id: `tab-${view.name}`, type: "button", role: "tab", "aria-controls": "view", click: () => store.set({ view: view.name }) }, view.title));
  const list = el("div", { class: "views", role: "tablist", "aria-label": "Views" }, ...tabs);
  list.addEventListener("keydown", (event) => {
    const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (!step) return;
    const open = suited.findIndex(({ name }) => name === store.state.view);
    const next = (open + step + suited.length) % suited.length;
    store.set({ view: suited[next]!.name });
    tabs[next]!.focus();
  });
  const show = (): void => {
    const view = suited.find(({ name }) => name === store.state.view) ?? suited[0]!;
    tabs.forEach((tab, index) => {
      tab.setAttribute("aria-selected", String(suited[index] === view));
      tab.tabIndex = suited[index] === view ? 0 : -1;
    });
    panel.setAttribute("aria-labelledby", `tab-${view.name}`);
    shown?.hide();
    let entry = made.get(view.name);
    if (entry) {
      panel.replaceChildren(entry.body);
      entry.show();
    } else {
      const quiet = whileShown(store);
      entry = { body: view.create(quiet.store), show: quiet.show, hide: quiet.hide };
      made.set(view.name, entry);
      panel.replaceChildren(entry.body);
    }
    shown = entry;
  };
  store.subscribe((_, changed) => {
    if (changed.has("view")) show();
  });
  show();
  const { chips, form } = createBrushes(store);
  return [el("nav", { class: "navigation" }, suited.length > 1 && list, el("span", { class: "spring" }), form), chips, el("main", {}, panel)];
}

void start();
