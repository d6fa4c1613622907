// What came of the drive, and what others came to on the same road.
import { el } from "../dom";
import { ask, type Ended } from "./wire";

interface Board {
  title: string;
  scoring: string;
  scores: { place: number | null; driver: string; met: number; of: number; worst: { share: number | null; requirement: string | null }; seconds: number; overruns: number; note: string }[];
}

const HEADS = { finished: "Driven to the end", crashed: "The drive broke down", limit: "The drive was ended", lost: "The drive broke off" };

export function showEnding(page: HTMLElement, ended: Ended, again: () => void, others: () => void): void {
  const verdicts = ended.verdicts.map(({ title, verdict }) =>
    el("li", {}, el("span", { class: `badge ${classOf(verdict)}` }, verdict), title));
  const link = ended.drive && el("a", { class: "go", href: `/drive/results/${encodeURIComponent(ended.drive)}` }, "Open the report");
  const heading = el("h1", { tabindex: -1 }, HEADS[ended.why] ?? "The drive is over");
  page.replaceChildren(
    el("header", { class: "top" }, heading),
    el("main", { class: "ending" },
      el("section", { class: "card" },
        el("p", { class: ended.why === "finished" ? "" : "problem", role: "status" }, `${ended.text.slice(0, 1).toUpperCase()}${ended.text.slice(1)}.`),
        verdicts.length ? el("ul", { class: "verdicts", "aria-label": "Verdicts" }, ...verdicts) : el("p", { class: "muted" }, "No requirement was judged."),
        el("p", { class: "next" }, link || null,
          el("button", { type: "button", click: again }, "Drive again"),
          el("button", { type: "button", click: others }, "Same car, other road"))),
      buildBoards()));
  heading.focus();
}

function classOf(verdict: string): string {
  return { pass: "pass", fail: "fail", "failed to run": "broken" }[verdict] ?? "open";
}

/** The score boards, once the server has told them; nothing if there are none. */
export function buildBoards(): HTMLElement {
  const box = el("section", { class: "boards", "aria-label": "Score boards" });
  ask<{ boards: Board[] }>("/drive/boards").then(
    ({ boards }) => box.replaceChildren(...boards.filter(({ scores }) => scores.length).map(draw)),
    (error: Error) => box.replaceChildren(el("p", { class: "muted" }, `The score boards cannot be shown: ${error.message}.`)),
  );
  return box;
}

const COLUMNS = ["Place", "Driver", "Requirements met", "Worst margin", "Time", "Overruns", ""];

function draw({ title, scoring, scores }: Board): HTMLElement {
  const rows = scores.map(({ place, driver, met, of, worst, seconds, overruns, note }) =>
    [place ? String(place) : "\u2013", driver, `${met} of ${of}`, worst.share === null ? "\u2013" : `${(100 * worst.share).toFixed(0)} %`, `${seconds.toFixed(0)} s`, String(overruns), note]);
  const table = el("table", {},
    el("thead", {}, el("tr", {}, ...COLUMNS.map((each) => el("th", { scope: "col" }, each)))),
    el("tbody", {}, ...rows.map((row) => el("tr", {}, ...row.map((cell) => el("td", {}, cell))))));
  return el("section", { class: "card" }, el("h2", {}, title), el("div", { class: "scroll", tabindex: 0 }, table), el("p", { class: "hint" }, scoring));
}
