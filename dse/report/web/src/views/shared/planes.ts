// Planes and parts of a study in words.
import type { Study } from "../../study";

/** `speed P gain × speed D gain`; "all variables" where none was held. */
export function planeName(study: Study, plane: readonly number[]): string {
  return plane.length ? plane.map((index) => study.variables[index]!.title).join(" \u00d7 ") : "all variables";
}
