// How many runs meet the requirements; the counts double as the legend of the plot.
import { countMarks, requirementsInWords, shownRuns, switchedOn } from "../counts";
import { el } from "../dom";
import { group, percent } from "../format";
import { plotted } from "../plane/plane";
import { drawShape, paintShape } from "../plot/points";
import { fit } from "../plot/sheet";
import type { State, Store } from "../store";
import { palette } from "../theme";
import { CLASSES, FAIL, PASS, WORDS, type Mark } from "../verdicts";

const ORDER: Mark[] = [0, 1, 2, 3];
const COUNTED: (keyof State)[] = ["thresholds", "configuration", "x", "y", "fixed", "brushes", "theme"];
const MEANING = ["meets every requirement that is switched on", "fails at least one", "not exercised: a pass there would be empty", "failed to run"];

export function createSummary(store: Store): HTMLElement {
  const head = el("p", { class: "headline" });
  const bar = el("div", { class: "share", "aria-hidden": "true" });
  const legend = el("ul", { class: "legend" });
  const box = el("div", { class: "summary" }, head, bar, legend);
  const draw = (): void => {
    const { overall, doubtful } = store.judgement();
    const shown = shownRuns(store);
    const within = store.within();
    const counts = countMarks(overall, shown, within);
    const total = sum(counts);
    const open = countDoubtful(overall, doubtful, shown, within);
    head.replaceChildren(
      el("b", { id: "passing" }, group(counts[PASS]!)),
      ` of ${group(total)} runs${scopeInWords(store)}${meeting(store)}`,
      el("span", { class: "muted" }, ` (${percent(counts[PASS]!, total)})`),
      el("span", { id: "doubtful" }, open ? `, ${group(open)} of them doubtful: ringed in the plot` : ""),
      el("span", { class: "muted", id: "everywhere" }, shown ? whole(store) : ""),
    );
    bar.replaceChildren(
      ...ORDER.filter((mark) => counts[mark]).map((mark) => {
        const part = el("span", { class: CLASSES[mark] });
        part.style.flexGrow = String(counts[mark]);
        return part;
      }),
    );
    legend.replaceChildren(
      ...ORDER.map((mark) => {
        const symbol = el("canvas", { class: "symbol", "aria-hidden": "true" });
        return el(
          "li",
          { title: MEANING[mark]! },
          symbol,
          el("span", {}, WORDS[mark]),
          el("b", { id: `count-${CLASSES[mark]}` }, group(counts[mark]!)),
        );
      }),
    );
    requestAnimationFrame(() => legend.querySelectorAll("canvas").forEach((canvas, index) => paintSymbol(canvas, ORDER[index]!)));
  };
  draw();
  store.subscribe((_, changed) => {
    if (COUNTED.some((key) => changed.has(key))) draw();
  });
  return box;
}

/** How many of the runs shown meet the requirements, as a sentence without its stop. */
export function inWords(store: Store): string {
  const counts = countMarks(store.judgement().overall, shownRuns(store), store.within());
  return `${counts[PASS]} of ${sum(counts)} runs${scopeInWords(store)}${meeting(store)}`;
}

function scopeInWords(store: Store): string {
  const within = store.within();
  const brushed = within ? " within the brushes" : "";
  if (!plotted(store.study)) return brushed;
  const { on, beside } = store.plane();
  if (!beside.length) return ` on this plane${brushed}`;
  const exactly = sum(countMarks(store.judgement().overall, on, within));
  return ` shown${brushed}, ${exactly ? group(exactly) : "none"} of them on this plane,`;
}

function meeting(store: Store): string {
  if (!store.study.requirements.length) return " came to their end; the bench has no requirements";
  return switchedOn(store).length ? ` meet ${requirementsInWords(store)}` : " came to their end; every requirement is switched off";
}

// What the plot leaves out must be told beside what it shows.
function whole(store: Store): string {
  const { overall } = store.judgement();
  const counts = countMarks(overall, null, store.within());
  const all = sum(counts);
  return all === sum(countMarks(overall, shownRuns(store), store.within())) ? "" : ` \u00b7 ${group(counts[PASS]!)} of all ${group(all)}`;
}

function countDoubtful(marks: Uint8Array, doubtful: Uint8Array, runs: Int32Array | null, within: Uint8Array | null): number {
  let found = 0;
  const size = runs ? runs.length : marks.length;
  for (let i = 0; i < size; i++) {
    const run = runs ? runs[i]! : i;
    if (marks[run] === PASS && doubtful[run] && (!within || within[run])) found++;
  }
  return found;
}

function sum(counts: number[]): number {
  return counts.reduce((total, value) => total + value, 0);
}

function paintSymbol(canvas: HTMLCanvasElement, mark: Mark): void {
  const { pen, width, height } = fit(canvas);
  pen.beginPath();
  drawShape(pen, width / 2, height / 2, mark, mark === FAIL ? 1.2 : 1);
  paintShape(pen, mark, 1, palette());
}
