// Choices go together: a formula is asked about configurations of the study only, not about mixtures of them.
import type { Part } from "../../insight";
import type { Study } from "../../study";
import { labelled, levelAt } from "../shared/places";

/** *places* with a choice at *level*, and the others as in the most similar configuration that has it. */
export function withLevel(study: Study, part: Part, places: number[], factor: number, level: number): number[] {
  const wanted = part.factors.map((axis, index) =>
    axis.variable < 0 ? (index === factor ? level : levelAt(axis, places[index]!)) : -1,
  );
  let [best, most] = [wanted, -1];
  for (const { choices } of study.configurations) {
    const chosen = new Map(choices);
    const levels = part.factors.map((axis, index) =>
      axis.variable >= 0
        ? -1
        : labelled(study, axis)
          ? wanted[index]!
          : axis.levels.indexOf(chosen.get(axis.title) ?? "absent"),
    );
    if (levels[factor] !== level || levels.some((each, index) => each < 0 && part.factors[index]!.variable < 0))
      continue;
    const alike = levels.filter((each, index) => each === wanted[index]).length;
    if (alike > most) [best, most] = [levels, alike];
  }
  return places.map((place, index) =>
    part.factors[index]!.variable < 0 ? (best[index]! + 0.5) / part.factors[index]!.levels.length : place,
  );
}
