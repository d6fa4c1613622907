// Objectives in words.

/** What an objective is about, without what is wanted of it. */
export function aimOf(objective: string): string {
  return objective.replace(/^(minimize|maximize) /, "");
}
