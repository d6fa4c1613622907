// How many runs meet the requirements; the counts double as the legend of the plot.

import { countMarks, requirementsInWords, shownRuns, switchedOn } from "../counts";
import { el } from "../dom";
import { group, percent } from "../format";
import { plotted } from "../plane/plane";
import { drawShape, paintShape } from "../plot/points";
import { fit } from "../plot/sheet";
import { conditionsInWords, everyCondition } from "../points";
import type { State, Store } from "../store";
import { palette } from "../theme";
import { CLASSES, FAIL, type Mark, NOT_EXERCISED, PASS, wordFor } from "../verdicts";

const ORDER: Mark[] = [0, 1, 2, 3];
const COUNTED: (keyof State)[] = ["thresholds", "configuration", "x", "y", "fixed", "brushes", "theme"];
const MEANING = [
  "meets every requirement that is switched on",
  "fails at least one",
  "not exercised: a pass there would be empty",
  "failed to run",
];
const UNDECIDED = "a requirement was not exercised, or not all conditions were run";

export function createSummary(store: Store): HTMLElement {
  const head = el("p", { class: "headline" });
  const bar = el("div", { class: "share", "aria-hidden": "true" });
  const legend = el("ul", { class: "legend" });
  const box = el("div", { class: "summary" }, head, bar, legend);
  const draw = (): void => {
    const {
      judgement: { overall, doubtful },
      within,
      noun,
    } = store.points();
    const shown = shownRuns(store);
    const counts = countMarks(overall, shown, within);
    const total = sum(counts);
    const open = countDoubtful(overall, doubtful, shown, within);
    head.replaceChildren(
      el("b", { id: "passing" }, group(counts[PASS]!)),
      ` of ${group(total)} ${noun}s${scopeInWords(store)}${meeting(store)}`,
      el("span", { class: "muted" }, ` (${percent(counts[PASS]!, total)})`),
      el("span", { id: "doubtful" }, open ? `, ${group(open)} of them doubtful: ringed in the plot` : ""),
      el("span", { class: "muted", id: "everywhere" }, whole(store)),
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
          { title: mark === NOT_EXERCISED && noun !== "run" ? UNDECIDED : MEANING[mark]! },
          symbol,
          el("span", {}, wordFor(mark, noun)),
          el("b", { id: `count-${CLASSES[mark]}` }, group(counts[mark]!)),
        );
      }),
    );
    requestAnimationFrame(() =>
      legend.querySelectorAll("canvas").forEach((canvas, index) => paintSymbol(canvas, ORDER[index]!)),
    );
  };
  draw();
  store.subscribe((_, changed) => {
    if (COUNTED.some((key) => changed.has(key))) draw();
  });
  return box;
}

/** How many of the runs shown meet the requirements, as a sentence without its stop. */
export function inWords(store: Store): string {
  const { judgement, within, noun } = store.points();
  const counts = countMarks(judgement.overall, shownRuns(store), within);
  return `${counts[PASS]} of ${sum(counts)} ${noun}s${scopeInWords(store)}${meeting(store)}`;
}

function scopeInWords(store: Store): string {
  const { within, judgement } = store.points();
  const brushed = within ? " within the brushes" : "";
  if (!plotted(store.study)) return brushed;
  const { on, beside } = store.plane();
  if (!beside.length) return ` on this plane${brushed}`;
  const exactly = sum(countMarks(judgement.overall, on, within));
  return ` shown${brushed}, ${exactly ? group(exactly) : "none"} of them on this plane,`;
}

function meeting(store: Store): string {
  const at = conditionsInWords(store.study, store.state);
  if (!store.study.requirements.length) return ` finished${at}; the bench has no requirements`;
  return switchedOn(store).length
    ? ` meet ${requirementsInWords(store)}${at}`
    : ` finished${at}; every requirement is switched off`;
}

// What the plot leaves out must be told beside what it shows.
function whole(store: Store): string {
  const { noun, runs, judgement, within } = store.designs();
  const counts = countMarks(judgement.overall, runs, within);
  const shown = countMarks(store.points().judgement.overall, shownRuns(store), store.points().within);
  const what = noun === "run" ? "" : ` designs${conditionsInWords(store.study, everyCondition(store.study))}`;
  return shown.every((each, mark) => each === counts[mark])
    ? ""
    : ` \u00b7 ${group(counts[PASS]!)} of all ${group(sum(counts))}${what}`;
}

function countDoubtful(
  marks: Uint8Array,
  doubtful: Uint8Array,
  runs: Int32Array | null,
  within: Uint8Array | null,
): number {
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
