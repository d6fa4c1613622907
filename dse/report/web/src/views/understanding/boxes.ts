// Boxes in which all requirements are met, as sentences, and how much may change around the robust centre.

import { rebrushed } from "../../brush";
import { el } from "../../dom";
import { group, number, percent, withUnit } from "../../format";
import type { Box, Centre, Range } from "../../insight";
import type { Store } from "../../store";
import { PASS } from "../../verdicts";
import { planeName } from "../shared/planes";
import { positionOf, runButton } from "../shared/runs";

export function createBoxes(store: Store): HTMLElement {
  const { study } = store;
  const { boxes, centres } = study.insight!;
  const shows = [...boxes, ...centres].some(({ ranges }) => ranges.length);
  const status = el("p", { class: "hint", id: "brushed", "aria-live": "polite" });
  const clear = el(
    "button",
    { type: "button", id: "clear-brushes", click: () => store.set({ brushes: [] }) },
    "Show all runs again",
  );
  const tell = (): void => {
    const {
      runs,
      within: mask,
      judgement: { overall },
      noun,
    } = store.designs();
    clear.hidden = !mask;
    if (!mask) {
      status.textContent = !shows ? "" : "\u2018Show\u2019 dims all runs outside the box, in every view.";
      return;
    }
    let [inside, passing] = [0, 0];
    for (const run of runs) {
      if (!mask[run]) continue;
      inside++;
      if (overall[run] === PASS) passing++;
    }
    status.textContent = `${group(passing)} of the ${group(inside)} ${noun}s inside pass.`;
  };
  tell();
  store.subscribe((_, changed) => {
    if (changed.has("brushes") || changed.has("thresholds")) tell();
  });
  return el(
    "div",
    { id: "boxes" },
    ...boxes.map((box) => row(store, sentenceOf(box), box.plane, box.ranges, box.choices)),
    ...centres.map((centre) => row(store, centreText(store, centre), centre.plane, centre.ranges, "", centre.run)),
    el("div", { class: "prediction" }, status, clear),
  );
}

function sentenceOf({ text }: Box): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

function centreText({ study, designs }: Store, { run, margin, around, limit, share, ranges }: Centre): string {
  const parts = ranges.map(
    ({ variable, low, high }) =>
      `${study.variables[variable]!.title} ${number(low, 3)} \u2026 ${withUnit(number(high, 3), study.variables[variable]!.unit)}`,
  );
  const { noun } = designs();
  const [value, low, high] = share.map((part) => percent(part ?? 0, 1));
  const end = limit < 0 ? "a range ends there" : `the nearest that does not pass is run ${limit}`;
  return `Around run ${run} all of these may change at once, by ${percent(margin, 1)} of their ranges: ${parts.join(", ")}. ${value} of ${group(around)} held-out ${noun}s inside pass (${low} \u2026 ${high}); ${end}.`;
}

function row(store: Store, text: string, plane: number[], ranges: Range[], choices: string, run = -1): HTMLElement {
  const { study } = store;
  const show = (): void => {
    let brushes = store.state.brushes.filter(({ column }) => !column.startsWith("variable."));
    for (const { variable, low, high } of ranges)
      brushes = rebrushed(brushes, `variable.${variable}`, widened(low, high));
    // Of a plane only its own runs: the others have the held variables elsewhere.
    if (plane.length) {
      study.variables.forEach(({ nominal }, index) => {
        if (!plane.includes(index)) brushes = rebrushed(brushes, `variable.${index}`, widened(nominal, nominal));
      });
    }
    store.set({ brushes });
  };
  const at = run < 0 ? -1 : positionOf(study, run);
  return el(
    "div",
    { class: "box-row" },
    el(
      "div",
      {},
      plane.length > 0 && el("span", { class: "muted" }, `${planeName(study, plane)}: `),
      text,
      choices && ranges.length > 0 ? el("span", { class: "muted" }, ` Choices (${choices}) are not brushed.`) : null,
    ),
    el(
      "div",
      { class: "box-buttons" },
      ranges.length > 0 && el("button", { type: "button", click: show }, "Show"),
      at >= 0 && runButton(store, at),
    ),
  );
}

// Ranges are rounded to six digits on their way here.
function widened(low: number, high: number): [number, number] {
  const rim = 2e-6 * Math.max(Math.abs(low), Math.abs(high));
  return [low - rim, high + rim];
}
