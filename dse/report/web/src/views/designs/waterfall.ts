// What each requirement leaves of the designs, in their order, and what dropping it would win.
import { el } from "../../dom";
import { group, percent } from "../../format";
import { PASS } from "../../verdicts";
import { type Model, subscribeCalmly } from "./model";

export function createWaterfall(model: Model): HTMLElement {
  const box = el("div", { class: "scroll" });
  const draw = (): void => box.replaceChildren(tableOf(model));
  subscribeCalmly(model, (changed) => {
    if (["demand", "thresholds", "brushes"].some((key) => changed.has(key as "demand"))) draw();
  });
  draw();
  return el(
    "div",
    { class: "waterfall" },
    box,
    el("p", { class: "hint" }, "Designs that no run showed to meet a requirement do not meet it."),
    ...spaceHint(model),
  );
}

function tableOf(model: Model): HTMLElement {
  const { store, grouping } = model;
  const { study, state } = store;
  const { each } = model.standing();
  const within = model.within();
  const left = Uint8Array.from({ length: grouping.size }, (_, design) => within?.[design] ?? 1);
  const all = sum(left);
  const whole = left.map((one, design) => (one && grouping.whole[design] && runsEnded(model, design) ? 1 : 0));
  const on = study.requirements.map((_, index) => index).filter((index) => !state.thresholds[index]!.off);
  const misses = whole.map((_, design) => on.filter((index) => each[index]![design] !== PASS).length);
  const rows = [row(`all designs${within ? " within the brushes" : ""}`, all, all, null, null)];
  if (sum(whole) < all) rows.push(row("finished at all conditions", sum(whole), all, all - sum(whole), null));
  left.set(whole);
  for (const index of on) {
    let [missed, freed] = [0, 0];
    for (let design = 0; design < left.length; design++) {
      if (!whole[design] || each[index]![design] === PASS) continue;
      missed++;
      if (misses[design] === 1) freed++;
      left[design] = 0;
    }
    rows.push(row(study.requirements[index]!.title, sum(left), all, missed, freed));
  }
  const heads = ["Requirement", "Left after it and those before", "Share", "Miss it", "Gained if it were dropped"].map(
    (text, place) => el("th", { scope: "col", class: place ? "numeric" : "" }, text),
  );
  return el(
    "table",
    { class: "boxes", id: "waterfall" },
    el("thead", {}, el("tr", {}, ...heads)),
    el("tbody", {}, ...rows),
  );
}

function row(title: string, left: number, all: number, missed: number | null, freed: number | null): HTMLElement {
  const bar = el("span", { class: "bar" });
  bar.style.width = `${(100 * left) / Math.max(1, all)}%`;
  const cell = (text: string): HTMLElement => el("td", { class: "numeric" }, text);
  return el(
    "tr",
    {},
    el("th", { scope: "row" }, title),
    cell(`${group(left)} (${percent(left, all)})`),
    el("td", { class: "drawn" }, bar),
    cell(missed === null ? "" : group(missed)),
    cell(freed === null ? "" : group(freed)),
  );
}

function runsEnded({ store, grouping }: Model, design: number): boolean {
  for (let i = grouping.start[design]!; i < grouping.start[design + 1]!; i++)
    if (!store.study.done[grouping.rows[i]!]) return false;
  return true;
}

function sum(flags: Uint8Array): number {
  return flags.reduce((total, flag) => total + flag, 0);
}

/** Which configurations there could be is asked of the design space, where that is not known here (funnel.ts). */
function spaceHint({ store }: Model): HTMLElement[] {
  if (store.study.notes?.funnel) return [];
  const space = store.study.facts.find(([key]) => key === "design space")?.[1];
  if (!space || store.study.configurations.length < 2) return [];
  const why = store.study.notes?.unfunnelled;
  return [
    el(
      "p",
      { class: "hint" },
      why ? `Not counted here: ${why}. ` : "",
      "What the static constraints leave of the design space before anything is simulated, and why a configuration is not among these designs: ",
      el("code", {}, `dse space constraints ${space}`),
      ", ",
      el("code", {}, `dse space explain ${space} --choose PLACE=ALTERNATIVE`),
      ".",
    ),
  ];
}
