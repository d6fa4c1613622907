// What is said of the run under the pointer, beside it.
import { el } from "../dom";
import { withUnit } from "../format";
import type { Store } from "../store";
import { CLASSES, SIGNS, WORDS } from "../verdicts";
import type { Plot } from "./plot";
import { placeOf } from "./points";

// With thirty variables the tip would be higher than the plot.
const MOST_LINES = 8;

/** Shows the tip at *run*, or hides it where there is none. */
export function moveTip(tip: HTMLElement, store: Store, plot: Plot, run: number): void {
  const frame = plot.frame();
  tip.hidden = run < 0 || !frame;
  if (run < 0 || !frame) return;
  const { study } = store;
  const { x: across, y: up } = plot.plane();
  const points = store.points();
  const { each } = store.judgement();
  const mark = points.judgement.overall[run]!;
  const line = (name: string, value: string, kind = ""): HTMLElement =>
    el("div", { class: "line" }, el("span", {}, name), el("b", { class: kind }, value));
  const variables = [across, up, ...study.variables.keys()]
    .filter((index, place, all) => all.indexOf(index) === place)
    .slice(0, MOST_LINES);
  tip.replaceChildren(
    el(
      "div",
      { class: "head" },
      `Run ${study.number[run]}`,
      el("span", { class: `badge ${CLASSES[mark]}` }, `${SIGNS[mark]} ${WORDS[mark]}`),
    ),
    ...variables.map((index) => {
      const { title, unit, values, text } = study.variables[index]!;
      return line(title, withUnit(text(values[run]!), unit));
    }),
    ...study.requirements.slice(0, MOST_LINES).map(({ metric }, index) => {
      const { title, unit, values, text } = study.metrics[metric]!;
      const verdict = each[index]![run]!;
      return line(title, `${withUnit(text(values[run]!), unit)} ${SIGNS[verdict]}`, CLASSES[verdict]);
    }),
  );
  const [x, y] = placeOf(frame, study, plot.plane(), points.first(run));
  const width = tip.offsetWidth;
  const height = tip.offsetHeight;
  tip.style.left = `${x + 16 + width > plot.surface.clientWidth ? Math.max(0, x - width - 14) : x + 14}px`;
  tip.style.top = `${Math.min(Math.max(4, y - height / 2), plot.surface.clientHeight - height - 4)}px`;
}
