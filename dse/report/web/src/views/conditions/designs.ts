// A design: a configuration with values for all variables that are for the designer to say.
import type { Study } from "../../study";

/** For each run the key of its design; variables of other roles than *design* do not count. */
export function designsOf(study: Study): string[] {
  const decided = study.variables.filter((_, index) => (study.insight?.asked.roles[index] ?? "design") === "design");
  return Array.from({ length: study.size }, (_, run) => {
    const values = decided
      .filter(({ lack }) => !lack.includes(study.configuration[run]!))
      .map(({ values: column }) => column[run]);
    return [study.configuration[run], ...values].join("|");
  });
}
