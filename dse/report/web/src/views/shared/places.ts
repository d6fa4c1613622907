// Where on a factor's axis a value lies: 0 … 1, and back.
import { number, shortened, withUnit } from "../../format";
import type { FactorAxis } from "../../insight";
import { MOST_TITLE, type Study, type Variable } from "../../study";

export function valueAt({ values }: FactorAxis, place: number): number {
  const at = place * (values.length - 1);
  const low = Math.min(values.length - 2, Math.floor(at));
  return values[low]! + (values[low + 1]! - values[low]!) * (at - low);
}

export function placeAt({ values }: FactorAxis, value: number): number {
  const last = values.length - 1;
  let above = values.findIndex((each) => each >= value);
  if (above < 0) above = last;
  let below = last;
  while (below > 0 && values[below]! > value) below--;
  // Of a variable that has certain values only, many places are one value.
  if (below >= above) return (below + above) / 2 / last;
  return Math.min(1, Math.max(0, (below + (value - values[below]!) / (values[above]! - values[below]!)) / last));
}

/** The values of a factor between which nothing is known; none of a choice, and of other numbers. */
export function apartOf(study: Study, { variable }: FactorAxis): number[] {
  return variable < 0 ? [] : study.variables[variable]!.apart;
}

/** The position of the value in *apart* that is nearest to a place. */
export function nearestOf(axis: FactorAxis, apart: number[], place: number): number {
  const away = apart.map((value) => Math.abs(value - valueAt(axis, place)));
  return away.indexOf(Math.min(...away));
}

export function levelAt({ levels }: FactorAxis, place: number): number {
  return Math.min(levels.length - 1, Math.floor(place * levels.length));
}

export function placeText(factor: FactorAxis, place: number): string {
  return factor.variable < 0
    ? factor.labels[levelAt(factor, place)]!
    : withUnit(number(valueAt(factor, place), 4), factor.unit);
}

/** What a run has of a choice: its configuration's, or the label of a variable that is an enumeration. */
export function levelOf(study: Study, factor: FactorAxis, run: number): string {
  const variable = labelled(study, factor);
  if (variable) return variable.text(variable.values[run]!);
  return (
    study.configurations[study.configuration[run]!]!.choices.find(([name]) => name === factor.title)?.[1] ?? "absent"
  );
}

/** The variable that a choice is, if it is no place of the design space. */
export function labelled(study: Study, factor: FactorAxis): Variable | undefined {
  return study.variables.find(
    ({ title, labels }) => labels.length > 0 && title === shortened(factor.title, MOST_TITLE),
  );
}

/** The place of a run on each factor; of no run (-1) the nominal one, or the first level. */
export function placesOf(study: Study, factors: FactorAxis[], run: number): number[] {
  return factors.map((factor) => {
    if (factor.variable >= 0) {
      const { values, nominal } = study.variables[factor.variable]!;
      return placeAt(factor, run < 0 ? nominal : values[run]!);
    }
    const level = run < 0 ? 0 : factor.levels.indexOf(levelOf(study, factor, run));
    return (Math.max(level, 0) + 0.5) / factor.levels.length;
  });
}
