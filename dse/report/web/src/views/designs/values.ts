// What designs come to: the mean over what is uncertain, at the condition where that is worst.
import { columnsOf, type Keyed } from "../../columns";
import { type Grouping, groupingOf } from "../../grouping";
import type { Store } from "../../store";
import type { Study } from "../../study";

/** Which way a column is better; "" where that is not known. */
export type Sense = "min" | "max" | "";

/** One value per design. */
export interface DesignColumn extends Omit<Keyed, "values"> {
  values: Float64Array;
  sense: Sense;
}

/** Columns that a design has a value of: not the conditions it is tried at, nor what is uncertain. */
export function designColumns(study: Study): Keyed[] {
  return columnsOf(study).filter(
    ({ key }) => !key.startsWith("variable.") || study.variables[place(key)]!.role === "design",
  );
}

export function place(key: string): number {
  return Number(key.slice(key.indexOf(".") + 1));
}

/** The study's objectives say which way is better, else requirements with one bound; a property is best small. */
export function senseOf({ study, state }: Store, key: string): Sense {
  const objective = study.objectives.find(({ column }) => column === key);
  if (objective) return objective.maximize ? "max" : "min";
  if (key.startsWith("property.")) return "min";
  if (!key.startsWith("metric.")) return "";
  const senses = study.requirements.flatMap(({ metric }, index): Sense[] => {
    const { atMost, atLeast } = state.thresholds[index]!;
    return metric !== place(key) ? [] : atLeast === null ? ["min"] : atMost === null ? ["max"] : [""];
  });
  return senses.length && senses.every((sense) => sense === senses[0]) ? senses[0]! : "";
}

/** NaN where any run of a design has none; without a sense the mean of all runs. Conditions at which all runs came to
 * their end and none has a value, as on a bench without the metric, are left out. */
export function aggregated(study: Study, values: Float64Array, sense: Sense): Float64Array {
  const grouping = groupingOf(study);
  if (grouping.size === study.size) return values;
  const measured = new Uint8Array(grouping.conditions);
  for (const [run, value] of values.entries()) {
    if (grouping.of[run]! >= 0 && !(study.done[run] && Number.isNaN(value))) measured[grouping.condition[run]!] = 1;
  }
  const found = new Float64Array(grouping.size);
  for (let design = 0; design < found.length; design++)
    found[design] = worstMean(grouping, measured, values, sense, design);
  return found;
}

function worstMean(
  { start, rows, condition }: Grouping,
  measured: Uint8Array,
  values: Float64Array,
  sense: Sense,
  design: number,
): number {
  const end = start[design + 1]!;
  let worst = NaN;
  for (let i = start[design]!; i < end; ) {
    const at = condition[rows[i]!];
    let sum = 0;
    let count = 0;
    for (; i < end && (sense === "" || condition[rows[i]!] === at); i++) {
      if (!measured[condition[rows[i]!]!]) continue;
      sum += values[rows[i]!]!;
      count++;
    }
    if (!count) continue;
    const mean = sum / count;
    if (Number.isNaN(mean)) return NaN;
    if (Number.isNaN(worst) || (sense === "max" ? mean < worst : mean > worst)) worst = mean;
  }
  return worst;
}
