// A decision in sentences; `dse compare DIR --designs A B` has the same.
import { type Decision, hasDraws, isCertain, isRandom } from "../../decision";
import { count, group, number, withUnit } from "../../format";
import type { Ahead, Aim, DesignOrder } from "../../order";
import type { Study } from "../../study";
import type { Threshold } from "../../verdicts";
import { shareText } from "../shared/margins";

const NAMES = { 1: "A", 0: "neither", "-1": "B" };

export function aheadIs(ahead: Ahead): string {
  return `${NAMES[ahead]} is ahead`;
}

/** Which of two *designs* is ahead, and why; *names* of both begin a sentence. */
export function orderText(
  aims: Aim[],
  order: DesignOrder,
  decision: Decision,
  designs: [number, number],
  names: [string, string] = ["A", "B"],
): string {
  const { ahead, by, missed, judged } = decision;
  const both = `Both miss ${few(missed[0])} of ${count(judged[0], "verdict")}`;
  if (!ahead) {
    const what = ["their least margins", ...aims.map(({ title }) => title)].join(" and in ");
    return `${both}. Neither is ahead: they are equal in ${what}.`;
  }
  const [one, other] = ahead > 0 ? designs : [designs[1], designs[0]];
  const [name, rest] = ahead > 0 ? names : [names[1], names[0]];
  const rival = rest.length > 1 ? rest[0]!.toLowerCase() + rest.slice(1) : rest;
  const start = `${name} is ahead`;
  if (!by) return `${start}: ${rival} was not run at all conditions.`;
  const level = (by - 1) >> 1;
  const counts = order.classes[level];
  if (counts) {
    const { severity, certain, doubtful } = counts;
    const of = `${group(Math.max(counts.judged[one]!, counts.judged[other]!))} ${classText(severity, order.classes.length)}`;
    if ((by - 1) % 2)
      return `${start}: both miss ${few(certain[one]!)} of ${of} for certain; of those that are doubtful it misses ${few(doubtful[one]!)}, ${rival} ${doubtful[other]}.`;
    const surely = doubtful[one] || doubtful[other] ? " for certain" : "";
    return `${start}: it misses ${few(certain[one]!)} of ${of}${surely}, ${rival} ${group(certain[other]!)}.`;
  }
  const aim = aims[by - 1 - 2 * order.classes.length];
  const value = (design: number): string =>
    aim ? withUnit(aim.text(aim.values[design]!), aim.unit) : shareText(order.slack[design]!);
  return `${both}. ${start}: its ${aim?.title ?? "least margin"} is ${value(one)}, that of ${rival} ${value(other)}.`;
}

function few(value: number): string {
  return value ? group(value) : "none";
}

/** Verdicts of a class of severity: `critical verdicts`; of the only one that has no name `verdicts`. */
export function classText(severity: string, classes: number): string {
  return severity ? `${severity} verdicts` : classes === 1 ? "verdicts" : "verdicts without a severity";
}

/** The order of designs in a sentence. */
export function orderSentence(aims: Aim[], { classes }: DesignOrder): string {
  const [first, ...others] = classes.map(({ severity }) => `missed ${classText(severity, classes.length)}`);
  const parts = [
    ...(first ? [`fewest ${first} (certain ones before doubtful ones)`] : []),
    ...others,
    ...aims.map(({ title, maximize }) => `${maximize ? "larger" : "smaller"} ${title}`),
    "larger least margin",
  ];
  return `${parts.join(", then ")}.`.replace(/^./, (letter) => letter.toUpperCase());
}

export function certaintyOf(study: Study, { cases }: Decision): string {
  if (!hasDraws(study))
    return "There are too many draws for this page: \u2018dse compare DIR --designs A B\u2019 compares them.";
  const random = cases.filter(({ counts }) => isRandom(counts));
  if (!cases.length) return "They have no condition in common.";
  if (!random.length) return "These runs have no noise: the differences are exact.";
  if (random.every(({ counts }) => counts.both + counts.first + counts.second + counts.neither === 1))
    return "Each verdict rests on one draw of the noise, so that no difference of rates is certain.";
  const certain = random.filter(({ counts }) => isCertain(counts.difference)).length;
  const where = `the rates differ with 95\u202f% confidence in ${certain ? group(certain) : "none"} of ${count(random.length, "verdict")}`;
  return `In the same draws, ${where}${certain ? "." : ": with other draws the order may differ."}`;
}

/** What would change the order, one sentence each. */
export function changesOf(
  study: Study,
  thresholds: Threshold[],
  aims: Aim[],
  { classes }: DesignOrder,
  decision: Decision,
): string[] {
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
    ...(decision.ahead && decision.by <= 2 * classes.length && aims.length
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
