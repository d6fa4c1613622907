// One sentence about the selected run and the counts, for those who listen to the page.
import { el } from "./dom";
import { withUnit } from "./format";
import { inWords } from "./panels/summary";
import type { Store } from "./store";
import { FAIL, WORDS } from "./verdicts";

export function createAnnouncement(store: Store): HTMLElement {
  const box = el("p", { id: "announcement", class: "unseen", "aria-live": "polite" });
  let timer = 0;
  const say = (): void => {
    box.textContent = sentence(store);
  };
  store.subscribe((_, changed) => {
    if (!changed.has("selected") && !changed.has("thresholds") && !changed.has("brushes")) return;
    // A slider being dragged changes many times a second; only where it rests is said.
    clearTimeout(timer);
    timer = window.setTimeout(say, 250);
  });
  say();
  return box;
}

function sentence(store: Store): string {
  const { study, state } = store;
  const { overall, each } = store.judgement();
  const share = `${inWords(store)}.`;
  const run = state.selected;
  if (run < 0) return share;
  const place = study.variables.map(
    ({ title, unit, values, text }) => `${title} ${withUnit(text(values[run]!), unit)}`,
  );
  const failing = study.requirements.filter((_, index) => each[index]![run] === FAIL).map(({ title }) => title);
  const why = failing.length ? ` (${failing.join(", ")})` : "";
  return `Run ${study.number[run]}${place.length ? `, ${place.join(", ")}` : ""}: ${WORDS[overall[run]!]}${why}. ${share}`;
}
