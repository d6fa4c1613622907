// What to know before relying on the numbers: said first, most serious first, and with a way to look.
import { el } from "../../dom";
import { count, group, percent } from "../../format";
import { conditionsInWords, everyCondition } from "../../points";
import { type Store, studyThresholds } from "../../store";
import { rowNoun, type Study } from "../../study";
import { FAILED, NOT_APPLICABLE, NOT_EXERCISED, PASS, tally } from "../../verdicts";
import { planeName } from "../shared/planes";
import { positionOf, runButton } from "../shared/runs";
import { isAsStudied } from "../shared/thresholds";

interface Warning {
  level: "bad" | "warn" | "note";
  text: string;
  run?: number;
}

const SIGN = { bad: "\u2717", warn: "!", note: "i" } as const;
const WORD = { bad: "problem", warn: "warning", note: "note" } as const;
const MOST_CAUSES = 3;
const UNCERTAIN = 0.02;

export function createWarnings(store: Store): HTMLElement {
  const list = el("ul", { class: "warning-list", id: "warnings", "aria-live": "polite" });
  const draw = (): void => {
    const found = warnings(store);
    const shown = found.length
      ? found
      : [
          {
            level: "note",
            text: "Nothing: all runs finished, every requirement was exercised in all of them, and no verdict is doubtful.",
          } as Warning,
        ];
    list.replaceChildren(
      ...shown.map(({ level, text, run }) =>
        el(
          "li",
          { class: level },
          el("span", { class: "sign", "aria-hidden": "true" }, SIGN[level]),
          el(
            "span",
            {},
            el("span", { class: "unseen" }, `${WORD[level]}: `),
            text,
            " ",
            run !== undefined && runButton(store, run),
          ),
        ),
      ),
    );
  };
  draw();
  store.subscribe((_, changed) => {
    if (changed.has("thresholds")) draw();
  });
  return list;
}

function warnings(store: Store): Warning[] {
  const { study } = store;
  return [
    ...nothingPasses(store),
    ...failures(study),
    ...missing(study),
    ...retried(study),
    ...notExercised(store),
    ...doubtful(store),
    ...draws(store.study),
    ...uncertain(study),
    ...atEdge(study),
    ...moved(store),
    ...unchecked(study),
  ];
}

function nothingPasses(store: Store): Warning[] {
  const { study, state } = store;
  if (!study.size) return [{ level: "bad", text: "There are no runs." }];
  const {
    judgement: { overall, each },
    noun,
  } = store.designs();
  if (!study.requirements.length || overall.includes(PASS)) return [];
  const never = study.requirements
    .filter((_, index) => !state.thresholds[index]!.off && !each[index]!.includes(PASS))
    .map(({ title }) => `\u201c${title}\u201d`);
  const why = never.length
    ? `No ${noun} meets ${never.join(" nor ")}.`
    : `Each requirement is met by some ${noun}, but no ${noun} meets all of them.`;
  return [
    {
      level: "bad",
      text: `No ${noun} meets all requirements${conditionsInWords(study, everyCondition(study))}. ${why}`,
    },
  ];
}

function failures(study: Study): Warning[] {
  const failed: number[] = [];
  for (let run = 0; run < study.size; run++) if (!study.done[run]) failed.push(run);
  if (!failed.length) return [];
  const causes = new Map<string, number>();
  for (const run of failed) {
    // The same cause at another time is the same cause.
    const cause = (study.problems.get(run) ?? "no reason was given")
      .split("\n")[0]!
      .replace(/[-+]?\d+(\.\d+)?(e[-+]?\d+)?/gi, "\u2026");
    causes.set(cause, (causes.get(cause) ?? 0) + 1);
  }
  const ordered = [...causes].sort((a, b) => b[1] - a[1]);
  const told = ordered.slice(0, MOST_CAUSES).map(([cause, times]) => `${cause.slice(0, 200)} (${group(times)})`);
  const rest = ordered.length > MOST_CAUSES ? `; and ${count(ordered.length - MOST_CAUSES, "other cause")}` : "";
  return [
    {
      level: "bad",
      text: `${group(failed.length)} of ${count(study.size, rowNoun(study))} failed to run: ${told.join("; ")}${rest}.`,
      run: failed[0]!,
    },
  ];
}

function missing(study: Study): Warning[] {
  const { unfinished } = study.insight!.asked;
  const open: Warning[] = unfinished
    ? [
        {
          level: "warn",
          text: `${count(unfinished, "run")} that the study asked for ${unfinished === 1 ? "is" : "are"} not there: it was stopped, or is still being made.`,
        },
      ]
    : [];
  return [...open, ...study.missing.map((text): Warning => ({ level: "warn", text: `${text}.` }))];
}

/** Runs that needed more than one try: their results are the same, but something is wrong with a model or a machine. */
function retried(study: Study): Warning[] {
  return study.retried.map(({ cause, count: runs, runs: first }) => {
    const numbers = first.join(", ") + (runs > first.length ? ", \u2026" : "");
    const why = cause.split("\n")[0]!.slice(0, 200);
    return {
      level: cause.startsWith("stopped") ? "note" : "warn",
      text: `${count(runs, "run")} (${numbers}) needed more than one try: ${why}.`,
    };
  });
}

function notExercised(store: Store): Warning[] {
  const { study, state } = store;
  const { each } = store.judgement();
  return study.requirements.flatMap((requirement, index) => {
    const counts = tally(study, each[index]!, -1);
    const open = counts[NOT_EXERCISED]!;
    if (!open || state.thresholds[index]!.off) return [];
    const when = study.insight!.asked.exercised[index];
    const whole = study.size - counts[FAILED]! - counts[NOT_APPLICABLE]!;
    const text = `\u201c${requirement.title}\u201d was not exercised in ${group(open)} of ${count(whole, rowNoun(study))}${when ? ` (it counts when ${when})` : ""}: they do not pass it.`;
    return [{ level: open === whole ? "bad" : "warn", text, run: each[index]!.indexOf(NOT_EXERCISED) } as Warning];
  });
}

function doubtful(store: Store): Warning[] {
  const { study } = store;
  const { overall, doubtful: marks } = store.judgement();
  const runs = [...marks.keys()].filter((run) => marks[run]);
  if (!runs.length) return [];
  const passing = runs.filter((run) => overall[run] === PASS).length;
  const noun = rowNoun(study);
  return [
    {
      level: "warn",
      text: `The verdict on ${count(runs.length, noun)} of ${group(study.size)} is doubtful: ${noun === "point" ? "more draws" : "finer numerics"} may change it. ${group(passing)} of them pass.`,
      run: runs[0]!,
    },
  ];
}

function draws({ facts, requirements }: Study): Warning[] {
  const noise = facts.find(([name]) => name === "noise")?.[1];
  if (!noise || !requirements.length) return [];
  const level = requirements.some(({ draws: made }) => made) ? "note" : "warn";
  return [{ level, text: `${noise[0]!.toUpperCase()}${noise.slice(1)}.` }];
}

function uncertain(study: Study): Warning[] {
  return study
    .insight!.chances.filter(({ uncertain: share }) => share > UNCERTAIN)
    .map(({ plane, requirement, uncertain: share }) => ({
      level: "warn",
      text: `The boundary of \u201c${study.requirements[requirement]!.title}\u201d is uncertain on ${percent(share, 1)} of the plane ${planeName(study, plane)}: 'dse refine DIR --band' writes a study of that part.`,
    }));
}

/** Only an objective makes what lies beyond a range better: a requirement is met or not. */
function atEdge(study: Study): Warning[] {
  const best = study.insight!.search?.picks[0];
  const run = best && study.insight!.search!.objectives.length === 1 ? positionOf(study, best.run) : -1;
  if (run < 0) return [];
  const { roles } = study.insight!.asked;
  const ends = study.variables.flatMap(({ title, low, high, values, lack }, index) => {
    if (roles[index] !== "design" || lack.includes(study.configuration[run]!)) return [];
    const place = (values[run]! - low) / (high - low);
    return place < 1e-6 ? [`lower end of ${title}`] : place > 1 - 1e-6 ? [`upper end of ${title}`] : [];
  });
  return ends.length
    ? [
        {
          level: "warn",
          text: `The best design is at the ${ends.join(" and the ")}: there may be a better one beyond the range.`,
          run,
        },
      ]
    : [];
}

function moved(store: Store): Warning[] {
  if (isAsStudied(store.state.thresholds, studyThresholds(store.study))) return [];
  return [
    {
      level: "note",
      text: "Thresholds are not the study\u2019s own: counts and margins follow them, sentences and stored picks do not.",
    },
  ];
}

function unchecked(study: Study): Warning[] {
  if (!study.size || study.metrics.some(({ error }) => error)) return [];
  return [
    {
      level: "note",
      text: "Numerical error was not checked for these runs. There are no error bars, and verdicts that finer numerics may change are not marked.",
    },
  ];
}
