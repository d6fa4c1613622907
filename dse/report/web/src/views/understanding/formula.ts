// Formulas made by dse/report/insight/responses.py, evaluated as by `evaluated` of dse/analysis/radial.py.
import type { FactorAxis, Part, Profile } from "../../insight";
import { levelAt } from "../shared/places";

/** Numbers from -1 to 1; of a choice one for each level but the first. */
export function featuresOf(factors: FactorAxis[], places: number[]): number[] {
  return factors.flatMap((factor, index) => {
    if (factor.variable >= 0) return [2 * places[index]! - 1];
    const level = levelAt(factor, places[index]!);
    return factor.levels.slice(1).map((_, other) => (other + 1 === level ? 1 : 0));
  });
}

/** The metric at *places*, in the unit shown. */
export function predict(part: Part, profile: Profile, places: number[]): number {
  const features = featuresOf(part.factors, places);
  const centres = part.centres[profile.centres]!;
  const size = features.length;
  const count = centres.length / size;
  const { weights, power } = profile;
  let sum = weights[count]!;
  for (let k = 0; k < size; k++) sum += weights[count + 1 + k]! * features[k]!;
  for (let j = 0; j < count; j++) {
    let square = 0;
    for (let k = 0; k < size; k++) square += (features[k]! - centres[j * size + k]!) ** 2;
    sum += weights[j]! * (power === 3 ? square * Math.sqrt(square) : Math.sqrt(square));
  }
  return sum;
}
