// Where on a factor's axis a value lies: 0 … 1, and back.
import { number, withUnit } from "../../format";
import type { FactorAxis } from "../../insight";

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

export function levelAt({ levels }: FactorAxis, place: number): number {
  return Math.min(levels.length - 1, Math.floor(place * levels.length));
}

export function placeText(factor: FactorAxis, place: number): string {
  return factor.variable < 0 ? factor.labels[levelAt(factor, place)]! : withUnit(number(valueAt(factor, place), 4), factor.unit);
}

/** The place of a run on each factor; the middle where the page does not know. */
export function placesOf(factors: FactorAxis[], value: (variable: number) => number, choice: (title: string) => string | undefined): number[] {
  return factors.map((factor) => {
    if (factor.variable >= 0) return placeAt(factor, value(factor.variable));
    const level = factor.levels.indexOf(choice(factor.title) ?? "absent");
    return ((level < 0 ? 0 : level) + 0.5) / factor.levels.length;
  });
}
