// What came of the drive, and what others came to on the same road.
import { el } from "../dom";
import { ask, type Ended } from "./messages";

interface Score {
  place: number | null;
  driver: string;
  drive: string | null;
  met: number;
  of: number;
  worst: { share: number | null; requirement: string | null };
  seconds: number;
  overruns: number;
  verdicts: { requirement: string; verdict: string }[];
  note: string;
  /** Where the report shows the drive over the run that nobody drove. */
  against?: string;
}

interface Board {
  bench: string;
  title: string;
  scoring: string;
  scores: Score[];
}

const AGAIN = 2000; // ms between two looks for a drive that is not on its board yet
const LOOKS = 60;
const HEADS = {
  finished: "The drive is over",
  crashed: "The simulation failed",
  limit: "The drive was stopped",
  lost: "The connection was lost",
};

export function showEnding(page: HTMLElement, ended: Ended, again: () => void, others: () => void): void {
  const verdicts = ended.verdicts.map(({ title, verdict }) =>
    el("li", {}, el("span", { class: `badge ${classOf(verdict)}` }, verdict), title),
  );
  const link =
    ended.drive &&
    el("a", { class: "go", href: `/drive/results/${encodeURIComponent(ended.drive)}` }, "Open the report");
  const heading = el("h1", { tabindex: -1 }, HEADS[ended.why] ?? "The drive is over");
  page.replaceChildren(
    el("header", { class: "top" }, heading),
    el(
      "main",
      { class: "ending" },
      el(
        "section",
        { class: "card" },
        el(
          "p",
          { class: ended.why === "finished" ? "" : "problem", role: "status" },
          `${ended.text.slice(0, 1).toUpperCase()}${ended.text.slice(1)}.`,
        ),
        verdicts.length
          ? el("ul", { class: "verdicts", "aria-label": "Verdicts" }, ...verdicts)
          : el("p", { class: "muted" }, "No requirement was judged."),
        el(
          "p",
          { class: "next" },
          link || null,
          el("button", { type: "button", click: again }, "Drive again"),
          el("button", { type: "button", click: others }, "Same car, other road"),
        ),
      ),
      buildBoards(ended.drive),
    ),
  );
  heading.focus();
}

function classOf(verdict: string): string {
  return { pass: "pass", fail: "fail", "failed to run": "broken" }[verdict] ?? "open";
}

/** The score boards, once the server has told them; nothing if there are none. The one with the drive `mine` comes first. */
export function buildBoards(mine: string | null = null): HTMLElement {
  const box = el("section", { class: "boards", "aria-label": "Score boards" });
  const show = async (looks: number): Promise<void> => {
    try {
      const { boards } = await ask<{ boards: Board[] }>("/drive/boards");
      const has = ({ scores }: Board): boolean => scores.some(({ drive }) => mine !== null && drive === mine);
      const isThere = mine === null || boards.some(has);
      const shown = boards.filter(({ scores }) => scores.length).sort((a, b) => Number(has(b)) - Number(has(a)));
      box.replaceChildren(...shown.map((board) => draw(board, mine)));
      if (isThere) return;
      box.prepend(
        el(
          "p",
          { class: "muted", role: "status" },
          looks
            ? "Your drive is simulated again for its score board \u2026"
            : "Your drive is on no score board; its report gives the reason.",
        ),
      );
      if (looks && box.isConnected) setTimeout(() => void show(looks - 1), AGAIN);
    } catch (error) {
      box.replaceChildren(
        el("p", { class: "muted" }, `The score boards cannot be shown: ${(error as Error).message}.`),
      );
    }
  };
  void show(LOOKS);
  return box;
}

const COLUMNS = ["Place", "Driver", "Requirements met", "Verdicts", "Worst margin", "Time", "Overruns", ""];

function draw({ bench, title, scoring, scores }: Board, mine: string | null): HTMLElement {
  const row = ({
    place,
    driver,
    drive,
    met,
    of,
    verdicts,
    worst,
    seconds,
    overruns,
    note,
    against,
  }: Score): HTMLElement => {
    const margin = worst.share === null ? "\u2013" : `${(100 * worst.share).toFixed(0)} % (${worst.requirement})`;
    const badges = verdicts.map(({ requirement, verdict }) =>
      el(
        "span",
        { class: `badge ${classOf(verdict)}`, title: verdict },
        requirement,
        el("span", { class: "unseen" }, ` ${verdict} `),
      ),
    );
    const compare =
      against && el("a", { href: `/study/${encodeURIComponent(bench)}/${against}` }, "against the controller");
    const cells = [
      place ? String(place) : "\u2013",
      driver,
      `${met} of ${of}`,
      el("span", { class: "badges" }, ...badges),
      margin,
      `${seconds.toFixed(0)} s`,
      String(overruns),
      el("span", { class: "notes" }, compare || null, note ? el("span", { class: "muted" }, note) : null),
    ];
    return el(
      "tr",
      { class: mine !== null && drive === mine ? "mine" : "" },
      ...cells.map((cell) => el("td", {}, cell)),
    );
  };
  const table = el(
    "table",
    {},
    el("thead", {}, el("tr", {}, ...COLUMNS.map((each) => el("th", { scope: "col" }, each)))),
    el("tbody", {}, ...scores.map(row)),
  );
  return el(
    "section",
    { class: "card" },
    el("h2", {}, title),
    el("div", { class: "scroll", tabindex: 0 }, table),
    el("p", { class: "hint" }, scoring),
  );
}
