// Runs that are worth a look: the best, the most robust, the nearest to the boundary.
import { el } from "../../dom";
import { number, percent, withUnit } from "../../format";
import { conditionsInWords, everyCondition } from "../../points";
import { type Store, studyThresholds } from "../../store";
import type { Study } from "../../study";
import { CLASSES, PASS, SIGNS, WORDS } from "../../verdicts";
import { aimOf } from "../shared/aims";
import { leastMargin, shareText } from "../shared/margins";
import { planeName } from "../shared/planes";
import { openRun, placeOf, positionOf } from "../shared/runs";
import { isAsStudied } from "../shared/thresholds";

const MOST_BEST = 3;

interface Choice {
  name: string;
  run: number;
  why: string;
  /** Found by Python, at the study's own thresholds. */
  stored?: boolean;
  /** Stands for all runs of its design, which have verdicts of their own. */
  design?: boolean;
}

export function createPicks(store: Store): HTMLElement {
  const box = el("div", { class: "picks-grid", id: "picks" });
  const draw = (): void => {
    const found = choices(store);
    const { noun } = store.designs();
    const at = conditionsInWords(store.study, everyCondition(store.study));
    const moved = !isAsStudied(store.state.thresholds, studyThresholds(store.study));
    box.replaceChildren(
      ...(found.length
        ? found.map((choice) => button(store, choice, moved))
        : [
            el(
              "p",
              { class: "hint" },
              `No ${noun} meets all requirements${at}${noun === "run" ? "" : ", though single runs may pass"}. Relax or switch off a requirement to see runs that come close.`,
            ),
          ]),
    );
  };
  draw();
  store.subscribe((_, changed) => {
    if (changed.has("thresholds") || changed.has("selected")) draw();
  });
  return box;
}

function button(store: Store, { name, run, why, stored, design }: Choice, moved: boolean): HTMLElement {
  const { study, state } = store;
  const mark = store.designs().judgement.overall[run]!;
  return el(
    "button",
    { type: "button", class: `pick${state.selected === run ? " chosen" : ""}`, click: () => openRun(store, run) },
    el(
      "span",
      { class: "pick-head" },
      el("b", {}, name),
      !design && el("span", { class: `badge ${CLASSES[mark]}` }, `${SIGNS[mark]} ${WORDS[mark]}`),
    ),
    el("span", { class: "pick-run" }, `Run ${study.number[run]}`),
    el("span", { class: "pick-why" }, why),
    el("span", { class: "pick-place" }, placeOf(study, run)),
    stored && moved && el("span", { class: "pick-place" }, "Found at the study\u2019s own thresholds."),
  );
}

function choices(store: Store): Choice[] {
  return [...(store.study.insight!.search ? searched(store.study) : []), ...byMargin(store), ...robust(store.study)];
}

function searched(study: Study): Choice[] {
  const { picks, objectives, units, knee } = study.insight!.search!;
  const shown =
    objectives.length === 1
      ? picks.slice(0, MOST_BEST).map((_, index) => index)
      : [...new Set([0, knee, picks.length - 1])].filter((index) => index >= 0 && index < picks.length);
  return shown
    .map((index) => {
      const pick = picks[index]!;
      const values = pick.values
        .map((value, place) => `${aimOf(objectives[place]!)} ${withUnit(number(value, 4), units[place]!)}`)
        .join(", ");
      const name =
        objectives.length === 1
          ? index
            ? `Best design, place ${index + 1}`
            : "Best design"
          : index === knee
            ? "Knee of the front"
            : index
              ? "Other end of the front"
              : "One end of the front";
      return {
        name,
        run: positionOf(study, pick.run),
        why: `${values}; shown is its run with the least margin`,
        stored: true,
        design: true,
      };
    })
    .filter(({ run }) => run >= 0);
}

function byMargin(store: Store): Choice[] {
  const { study } = store;
  if (!study.requirements.length || store.state.thresholds.every(({ off }) => off)) return [];
  const {
    judgement: { overall },
    runs,
    deciding,
  } = store.designs();
  let [best, near] = [-1, -1];
  let [most, least] = [-Infinity, Infinity];
  let passing = 0;
  for (const first of runs) {
    if (overall[first] !== PASS) continue;
    passing++;
    const run = deciding(first);
    const here = leastMargin(store, run);
    if (here > most) [most, best] = [here, run];
    if (here < least) [least, near] = [here, run];
  }
  if (best < 0) return [];
  const told = (run: number): string => `its least margin is ${shareText(leastMargin(store, run))}`;
  // Where none has more to spare than another there is one pick, and no difference to show.
  if (most === least)
    return [
      {
        name: passing === 1 ? "The only one that passes" : "All that pass are equally near",
        run: best,
        why: told(best),
      },
    ];
  return [
    { name: "Most to spare", run: best, why: told(best) },
    { name: "Nearest to the boundary", run: near, why: told(near) },
  ];
}

function robust(study: Study): Choice[] {
  return study
    .insight!.centres.map((centre) => ({
      name: centre.plane.length ? `Most robust in ${planeName(study, centre.plane)}` : "Most robust",
      run: positionOf(study, centre.run),
      why: `where every number changes by up to ${percent(centre.margin, 1)} of its range at once, ${percent(centre.share[0] ?? 0, 1)} of held-out runs pass`,
      stored: true,
    }))
    .filter(({ run }) => run >= 0);
}
