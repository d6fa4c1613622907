// Tabs, and below them the open view; a view is made when it is first opened. For paper all stand one after the other.
import { el } from "./dom";
import { createBrushes } from "./panels/brushes";
import { type Store, whileShown } from "./store";
import type { View } from "./views/view";
import { VIEWS } from "./views/views";

interface Made {
  body: HTMLElement;
  show: () => void;
  hide: () => void;
}

export interface Tabs {
  elements: HTMLElement[];
  /** Shows all views below each other, until one is printed or opened. */
  stack: () => void;
}

export function createTabs(store: Store): Tabs {
  const suited = VIEWS.filter((view) => view.suits(store.study));
  const made = new Map<string, Made>();
  const panel = el("div", { id: "view", role: "tabpanel", tabindex: -1 });
  const tabs = suited.map((view) =>
    el(
      "button",
      { id: `tab-${view.name}`, type: "button", role: "tab", "aria-controls": "view", click: () => open(view) },
      view.title,
    ),
  );
  const list = el("div", { class: "views", role: "tablist", "aria-label": "Views" }, ...tabs);
  const opened = (): View => suited.find(({ name }) => name === store.state.view) ?? suited[0]!;
  const open = (view: View): void => {
    if (view === opened()) show();
    else store.set({ view: view.name });
  };
  list.addEventListener("keydown", (event) => {
    const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (!step) return;
    const next = (suited.indexOf(opened()) + step + suited.length) % suited.length;
    open(suited[next]!);
    tabs[next]!.focus();
  });
  // A view is put into the page right after it was made, so that it can be measured.
  const put = (view: View, place: HTMLElement): void => {
    const entry = made.get(view.name);
    if (entry) {
      place.append(entry.body);
      entry.show();
      return;
    }
    const { store: quiet, show, hide } = whileShown(store);
    const body = view.create(quiet);
    made.set(view.name, { body, show, hide });
    place.append(body);
  };
  const show = (): void => {
    const view = opened();
    tabs.forEach((tab, index) => {
      tab.setAttribute("aria-selected", String(suited[index] === view));
      tab.tabIndex = suited[index] === view ? 0 : -1;
    });
    panel.setAttribute("aria-labelledby", `tab-${view.name}`);
    for (const { hide } of made.values()) hide();
    panel.replaceChildren();
    put(view, panel);
  };
  const stack = (): void => {
    document.documentElement.dataset.printing = "yes";
    panel.replaceChildren();
    for (const view of suited) {
      const section = el("section", { class: `printed ${view.name}-printed` }, el("h2", {}, view.title));
      panel.append(section);
      put(view, section);
    }
  };
  window.addEventListener("afterprint", () => {
    if (!document.documentElement.dataset.printing) return;
    delete document.documentElement.dataset.printing;
    show();
  });
  store.subscribe((_, changed) => {
    if (changed.has("view")) show();
  });
  show();
  const { chips, form } = createBrushes(store);
  const navigation = el(
    "nav",
    { class: "navigation" },
    suited.length > 1 && list,
    el("span", { class: "spring" }),
    form,
  );
  return { elements: [navigation, chips, el("main", {}, panel)], stack };
}
