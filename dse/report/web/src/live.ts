// A report that a server has given: how the study is getting on, new runs, stopping it. A report that is a file has none.
import { el } from "./dom";
import { count, group } from "./format";
import { answered, post } from "./live/requests";
import { createTrying } from "./live/whatif";
import type { Store } from "./store";

interface Entry {
  study: string;
  /** How many runs this page has. */
  runs: number;
  query: string;
  problems: string[];
}

interface Progress {
  state: "running" | "finished" | "interrupted" | "at rest";
  runs: number;
  finished: number;
  rate?: number;
  left?: number;
  writer?: string;
}

/** Milliseconds after which whoever was asked to stop should have. */
const PATIENCE = 20000;

const EVERY = { running: 2000, otherwise: 10000 };

export function startLive(store: Store): void {
  const given = document.getElementById("live");
  if (!given) return;
  const entry = JSON.parse(given.textContent!) as Entry;
  const state = el("span", { class: "state" }, "\u2026");
  const meter = el("progress", { max: 1, value: 0, "aria-label": "runs that are done" });
  const told = el("span", { class: "muted", id: "live-told" });
  const news = el("button", { type: "button", id: "live-news", hidden: true, click: () => location.reload() });
  const stop = el("button", { type: "button", id: "live-stop", hidden: true, click: () => void ask() }, "Stop");
  const said = el("span", { class: "muted", role: "status", id: "live-said" });
  const trying = createTrying(store, entry.query);
  const bar = el(
    "nav",
    { class: "live", "aria-label": "Study being served" },
    el("a", { href: "/" }, "All studies"),
    state,
    meter,
    told,
    news,
    stop,
    said,
    el("span", { class: "spring" }),
    trying.button,
  );
  document.body.prepend(bar, ...entry.problems.map((text) => el("p", { class: "live problem" }, text)));
  document.body.append(trying.panel);
  new ResizeObserver(() => (trying.panel.style.top = `${bar.offsetHeight}px`)).observe(bar);

  let asked = Infinity;
  const ask = async (): Promise<void> => {
    stop.disabled = true;
    said.textContent = "requesting a stop \u2026";
    try {
      await post(`/stop?${entry.query}`, {});
      asked = performance.now();
      said.textContent = "stop requested; finished runs are stored";
    } catch (error) {
      said.textContent = String((error as Error).message);
      stop.disabled = false;
    }
  };

  const show = (now: Progress): void => {
    bar.dataset.state = now.state;
    const isRunning = now.state === "running";
    state.textContent = now.state;
    meter.value = now.runs ? now.finished / now.runs : 1;
    const parts = [`${group(now.finished)} of ${count(now.runs, "run")}`];
    if (now.rate) parts.push(`${now.rate < 10 ? now.rate.toPrecision(2) : group(Math.round(now.rate))} runs/s`);
    if (now.left) parts.push(`about ${duration(now.left)} left`);
    told.textContent = parts.join(" \u00b7 ");
    told.title = now.writer ? `explored by ${now.writer}` : "";
    const more = now.finished - entry.runs;
    news.hidden = more === 0;
    news.textContent = more > 0 ? `${count(more, "new run")} \u2013 show` : "The study was restarted \u2013 show";
    if (isRunning && performance.now() - asked > PATIENCE) {
      said.textContent = "it has not stopped yet";
      stop.disabled = false;
      asked = Infinity;
    }
    if (!isRunning && !stop.hidden) {
      said.textContent = now.state === "interrupted" ? "stopped; the same command resumes" : "";
      stop.disabled = false;
    }
    stop.hidden = !isRunning;
  };

  const look = async (): Promise<void> => {
    let wait = EVERY.otherwise;
    if (!document.hidden) {
      try {
        const now = (await answered(await fetch(`/progress?${entry.query}`))) as Progress;
        show(now);
        if (now.state === "running") wait = EVERY.running;
      } catch (error) {
        bar.dataset.state = "gone";
        state.textContent = "no answer";
        told.textContent =
          error instanceof TypeError
            ? "the server does not answer; this page stays as it is"
            : String((error as Error).message);
        stop.hidden = true;
      }
    }
    setTimeout(() => void look(), wait);
  };
  void look();
}

function duration(seconds: number): string {
  if (seconds < 90) return `${Math.ceil(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}
