// Puts the page together.

import { startingRun } from "./actions";
import { followAddress, readFragment } from "./address";
import { createAnnouncement } from "./announcement";
import { shownRuns } from "./counts";
import { el } from "./dom";
import { count } from "./format";
import { groupingOf, variablesOf } from "./grouping";
import { startLive } from "./live";
import { orderAt } from "./order";
import { startingPoint } from "./plane/plane";
import { createStore, type State, type Store, studyThresholds } from "./store";
import { readStudy, rowNoun, type Study, type Variable } from "./study";
import { createTabs } from "./tabs";
import { followTheme, startTheme } from "./theme";
import { PASS } from "./verdicts";
import { VIEWS } from "./views/views";

const DRAWN = 1000;

async function start(): Promise<void> {
  const page = document.getElementById("page")!;
  const theme = startTheme();
  try {
    const study = await readStudy();
    const store = createStore(study, initial(study, theme));
    const here = startingRun(store, shownRuns(store));
    const { overall } = store.designs().judgement;
    // A configuration without a design that passes is no place to begin at if another has one.
    const anywhere = overall[here] === PASS ? here : startingRun(store, study.number.keys());
    const selected = overall[anywhere] === PASS || here < 0 ? anywhere : firstInOrder(store);
    store.set({ selected, configuration: selected < 0 ? 0 : study.configuration[selected]! });
    const start = store.state;
    store.set(readFragment(study, location.hash.slice(1), start));
    const tabs = createTabs(store);
    page.replaceChildren(header(store, tabs.stack), ...tabs.elements, createAnnouncement(store));
    if (new URLSearchParams(location.hash.slice(1)).has("print")) tabs.stack();
    followAddress(store, start);
    startLive(store);
    document.documentElement.dataset.ready = "yes";
  } catch (error) {
    const hint =
      "DecompressionStream" in window
        ? ""
        : " This browser is too old: it cannot unpack the data (DecompressionStream).";
    page.replaceChildren(el("p", { class: "card problem" }, `The report cannot be shown: ${String(error)}.${hint}`));
    throw error;
  }
}

/** The run that decides on the design to take; where none passes, the page begins there. */
function firstInOrder(store: Store): number {
  const design = orderAt(store).ranked[0]!;
  return store.designs().deciding(groupingOf(store.study).first[design]!);
}

function isCondition({ variables }: Study, index: number): boolean {
  return variables[index]!.role === "condition";
}

function initial(study: Study, theme: State["theme"]): State {
  const byRole = [...study.variables.keys()].sort(
    (a, b) => Number(isCondition(study, a)) - Number(isCondition(study, b)),
  );
  const [x, y] = study.slices[0] ?? (byRole.length > 1 ? byRole : [0, 1]);
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

function header(store: Store, stack: () => void): HTMLElement {
  const { study } = store;
  const theme = followTheme(store);
  const parts = [count(study.size, rowNoun(study))];
  if (study.configurations.length > 1) parts.push(count(study.configurations.length, "configuration"));
  const ofRole = (role: Variable["role"], noun: string): void => {
    const those = variablesOf(study, role).length;
    if (those) parts.push(count(those, noun));
  };
  if (store.designs().noun === "design") parts.push(count(groupingOf(study).size, "design"));
  ofRole("design", "design variable");
  if (variablesOf(study, "condition").length) parts.push(count(groupingOf(study).conditions, "condition"));
  ofRole("uncertain", "uncertain variable");
  parts.push(count(study.requirements.length, "requirement"));
  const button = el("button", { id: "theme", type: "button", click: theme.toggle }, "");
  const name = (): void => {
    button.textContent = store.state.theme === "dark" ? "Light mode" : "Dark mode";
  };
  name();
  store.subscribe(name);
  const print = el(
    "button",
    { id: "print", type: "button", title: "Prints all views, one after the other", click: () => void printAll(stack) },
    "Print",
  );
  return el(
    "header",
    {},
    el("h1", { title: study.title }, study.title),
    el("span", { class: "muted", title: parts.join(" \u00b7 ") }, parts.join(" \u00b7 ")),
    el("span", { class: "spring" }),
    el("span", { class: "tools" }, print, button),
  );
}

// What is drawn on canvases has to be on paper's width, and drawn, before the browser looks at it.
async function printAll(stack: () => void): Promise<void> {
  stack();
  await new Promise((done) => setTimeout(done, DRAWN));
  window.print();
}

void start();
