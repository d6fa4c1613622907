// Pointing, clicking and arrow keys on the constraint plot.
import { el } from "../dom";
import { withUnit } from "../format";
import { selectRun } from "../actions";
import type { Store } from "../store";
import { CLASSES, SIGNS, WORDS } from "../verdicts";
import type { Plot } from "./plot";
import { placeOf } from "./points";

const REACH = 18;
const ON_RUN = 5;
const ARROWS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

export function attachInteraction(store: Store, plot: Plot): void {
  const tip = el("div", { class: "tip", "aria-hidden": "true", hidden: true });
  plot.surface.append(tip);
  const at = (event: MouseEvent): [number, number] => {
    const box = plot.surface.getBoundingClientRect();
    return [event.clientX - box.left - plot.surface.clientLeft, event.clientY - box.top - plot.surface.clientTop];
  };
  plot.surface.addEventListener("pointermove", (event) => {
    const [x, y] = at(event);
    const run = nearest(store, plot, x, y, REACH);
    plot.hover(run);
    showTip(tip, store, plot, run);
  });
  plot.surface.addEventListener("pointerleave", () => {
    plot.hover(-1);
    tip.hidden = true;
  });
  plot.surface.addEventListener("click", (event) => {
    const run = nearest(store, plot, ...at(event), 3 * REACH);
    if (run >= 0) selectRun(store, run);
    tellPlace(plot, ...at(event), nearest(store, plot, ...at(event), ON_RUN) >= 0);
  });
  plot.surface.addEventListener("keydown", (event) => {
    const direction = ARROWS[event.key];
    if (!direction || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    tip.hidden = true;
    plot.hover(-1);
    const run = neighbour(store, plot, direction);
    if (run >= 0) selectRun(store, run);
  });
}

/** Beside the runs, whoever wants to know hears where: a served report can simulate there. */
function tellPlace(plot: Plot, x: number, y: number, isRun: boolean): void {
  const frame = plot.frame();
  if (!frame || isRun) return;
  const detail = { x: frame.x.invert(x), y: frame.y.invert(y) };
  plot.surface.dispatchEvent(new CustomEvent("pointed-at", { bubbles: true, detail }));
}

function nearest(store: Store, plot: Plot, x: number, y: number, reach: number): number {
  const frame = plot.frame();
  if (!frame) return -1;
  let best = -1;
  let least = reach * reach;
  for (const run of shown(plot)) {
    const [a, b] = placeOf(frame, store.study, plot.plane(), run);
    const square = (a - x) ** 2 + (b - y) ** 2;
    if (square < least) {
      least = square;
      best = run;
    }
  }
  return best;
}

/** The closest run in a direction; steps aside count three times, so that a row of a grid is kept. */
export function neighbour(store: Store, plot: Plot, [dx, dy]: [number, number]): number {
  const frame = plot.frame();
  const runs = shown(plot);
  if (!frame || !runs.length) return -1;
  const from = store.state.selected;
  if (from < 0 || !runs.includes(from)) return runs[0]!;
  const [x, y] = placeOf(frame, store.study, plot.plane(), from);
  let best = -1;
  let least = Infinity;
  for (const run of runs) {
    const [a, b] = placeOf(frame, store.study, plot.plane(), run);
    const along = (a - x) * dx + (b - y) * dy;
    const aside = Math.abs((a - x) * dy) + Math.abs((b - y) * dx);
    if (along < 0.5 || aside > 2 * along) continue;
    const score = along + 3 * aside;
    if (score < least) {
      least = score;
      best = run;
    }
  }
  return best;
}

function shown(plot: Plot): Int32Array {
  const { on, beside } = plot.plane();
  if (!beside.length) return on;
  const both = new Int32Array(on.length + beside.length);
  both.set(on);
  both.set(beside, on.length);
  return both;
}

function showTip(tip: HTMLElement, store: Store, plot: Plot, run: number): void {
  const frame = plot.frame();
  tip.hidden = run < 0 || !frame;
  if (run < 0 || !frame) return;
  const { study } = store;
  const { overall, each } = store.judgement();
  const mark = overall[run]!;
  const line = (name: string, value: string, kind = ""): HTMLElement =>
    el("div", { class: "line" }, el("span", {}, name), el("b", { class: kind }, value));
  tip.replaceChildren(
    el("div", { class: "head" }, `Run ${study.number[run]}`, el("span", { class: `badge ${CLASSES[mark]}` }, `${SIGNS[mark]} ${WORDS[mark]}`)),
    ...study.variables.map(({ title, unit, values, text }) => line(title, withUnit(text(values[run]!), unit))),
    ...study.requirements.map(({ metric }, index) => {
      const { title, unit, values, text } = study.metrics[metric]!;
      const verdict = each[index]![run]!;
      return line(title, `${withUnit(text(values[run]!), unit)} ${SIGNS[verdict]}`, CLASSES[verdict]);
    }),
  );
  const [x, y] = placeOf(frame, study, plot.plane(), run);
  const width = tip.offsetWidth;
  const height = tip.offsetHeight;
  tip.style.left = `${x + 16 + width > plot.surface.clientWidth ? x - width - 14 : x + 14}px`;
  tip.style.top = `${Math.min(Math.max(4, y - height / 2), plot.surface.clientHeight - height - 4)}px`;
}
