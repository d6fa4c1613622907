// How many runs meet the requirements; the counts double as the legend of the plot.
import { el, fit } from "../dom";
import { group, percent } from "../format";
import { drawShape, paintShape } from "../plot/points";
import type { Store } from "../store";
import { palette } from "../theme";
import { CLASSES, FAIL, PASS, tally, WORDS, type Mark } from "../verdicts";

const ORDER: Mark[] = [0, 1, 2, 3];
const MEANING = ["meets every requirement", "fails at least one", "not exercised: a pass there would be empty", "failed to run"];

export function scope(store: Store): number {
  return store.study.variables.length && store.study.configurations.length > 1 ? store.state.configuration : -1;
}

export function createSummary(store: Store): HTMLElement {
  const head = el("p", { class: "headline" });
  const bar = el("div", { class: "share", "aria-hidden": "true" });
  const legend = el("ul", { class: "legend" });
  const box = el("div", { class: "summary" }, head, bar, legend);
  const draw = (): void => {
    const { study } = store;
    const { overall, doubtful } = store.judgement();
    const counts = tally(study, overall, scope(store));
    const open = tally(study, overall.map((mark, run) => (doubtful[run] ? mark : FAIL)), scope(store))[PASS]!;
    const total = counts.reduce((sum, value) => sum + value, 0);
    const what = study.requirements.length
      ? ` of ${group(total)} runs meet every requirement`
      : ` of ${group(total)} runs came to their end; the bench has no requirements`;
    head.replaceChildren(
      el("b", { id: "passing" }, group(counts[PASS]!)),
      what,
      el("span", { class: "muted" }, ` (${percent(counts[PASS]!, total)})`),
      el("span", { id: "doubtful" }, open ? `, ${group(open)} of them doubtful: ringed in the plot` : ""),
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
    if (changed.has("thresholds") || changed.has("configuration") || changed.has("theme")) draw();
  });
  return box;
}

function paintSymbol(canvas: HTMLCanvasElement, mark: Mark): void {
  const { pen, width, height } = fit(canvas);
  pen.beginPath();
  drawShape(pen, width / 2, height / 2, mark, mark === FAIL ? 1.2 : 1);
  paintShape(pen, mark, 1, palette());
}
