// A decision in sentences; `dse compare DIR --designs A B` has the same.
import { type Ahead, type Aim, type Decision, hasDraws, isCertain, isRandom } from "../../decision";
import { count, group, number, withUnit } from "../../format";
import type { Study } from "../../study";
import type { Threshold } from "../../verdicts";

const NAMES = { 1: "A", 0: "neither", "-1": "B" };

export function aheadIs(ahead: Ahead): string {
  return `${NAMES[ahead]} is ahead`;
}

export function orderOf(aims: Aim[], { missed, judged, ahead, objectives }: Decision): string {
  const [a, b] = missed;
  const of = count(Math.max(...judged), "verdict");
  if (a !== b) {
    const [less, more, other] = a < b ? [a, b, "B"] : [b, a, "A"];
    const has = less
      ? `misses ${group(less)} of ${of}, ${other} ${group(more)}`
      : `misses none of ${of}, ${other} ${group(more)}`;
    return `${aheadIs(ahead)}: it ${has}.`;
  }
  const both = a ? `Both miss ${group(a)} of ${of}` : `Both miss none of ${of}`;
  const better = (side: 1 | -1): string =>
    aims
      .filter(({ maximize }, place) => {
        const [one, other] = objectives[place]!;
        return Math.sign((maximize ? one - other : other - one) || 0) === side;
      })
      .map(({ title }) => title)
      .join(", ");
  if (!aims.length) return `${both}, and the study has neither an objective nor a price.`;
  if (ahead)
    return `${both}. ${aheadIs(ahead)}: it is better in ${better(ahead)}${aims.length > 1 ? ", and worse in no objective" : ""}.`;
  if (!better(1) && !better(-1)) return `${both}, and they are equal in ${aims.map(({ title }) => title).join(", ")}.`;
  return `${both}. Neither is ahead: A is better in ${better(1)}, B in ${better(-1)}.`;
}

export function certaintyOf(study: Study, { cases }: Decision): string {
  if (!hasDraws(study))
    return "There are too many draws for this page: \u2018dse compare DIR --designs A B\u2019 compares them.";
  const random = cases.filter(({ counts }) => isRandom(counts));
  if (!cases.length) return "They have no case in common.";
  if (!random.length) return "These runs have no noise: the differences are exact.";
  if (random.every(({ counts }) => counts.both + counts.first + counts.second + counts.neither === 1))
    return "Each verdict rests on one draw of the noise, so that no difference of rates is certain.";
  const certain = random.filter(({ counts }) => isCertain(counts.difference)).length;
  const where = `the rates differ with 95\u202f% confidence in ${certain ? group(certain) : "none"} of ${count(random.length, "verdict")}`;
  return `In the same draws, ${where}${certain ? "." : ": with other draws the order may differ."}`;
}

/** What would change the order, one sentence each. */
export function changesOf(study: Study, thresholds: Threshold[], aims: Aim[], decision: Decision): string[] {
  const bounds = decision.bounds.map(({ requirement, shift, ahead }) => {
    const { title, metric } = study.requirements[requirement]!;
    const { unit } = study.metrics[metric]!;
    return `${title}: with ${boundText(thresholds[requirement]!, shift, unit)}, ${aheadIs(ahead)}.`;
  });
  const changes = decision.changes.map(({ objective, change, ahead }) => {
    const { title, unit, text } = aims[objective]!;
    const [way, other] = change > 0 ? ["higher", "lower"] : ["lower", "higher"];
    const by = withUnit(text(Math.abs(change)), unit);
    return `${title}: if A\u2019s is ${way} by more than ${by}, or B\u2019s ${other} by more than that, ${aheadIs(ahead)}.`;
  });
  return [
    ...(bounds.length ? bounds : ["No other bound of a single requirement changes the order."]),
    ...(decision.missed[0] !== decision.missed[1] && aims.length
      ? [
          `The order follows from the verdicts: no other value of ${aims.map(({ title }) => title).join(", ")} changes it.`,
        ]
      : changes),
  ];
}

function boundText({ atLeast, atMost }: Threshold, shift: number, unit: string): string {
  const shown = (value: number): string => withUnit(number(value), unit);
  const looser = shift < 0;
  if (atLeast !== null && atMost !== null)
    return `both bounds ${looser ? "" : "more than "}${shown(Math.abs(shift))} ${looser ? "looser" : "tighter"}`;
  const [bound, moved] = atLeast !== null ? [atLeast, atLeast + shift] : [atMost!, atMost! - shift];
  const how = atLeast !== null ? (looser ? "at least" : "more than") : looser ? "at most" : "less than";
  return `${how} ${shown(moved)} instead of ${shown(bound)}`;
}
