// What was studied, and where the numbers come from: in a page without an overview, which has it too.
import { createFacts } from "../panels/facts";
import type { View } from "./view";

export const studyView: View = {
  name: "study",
  title: "Study",
  suits: ({ insight }) => insight === null,
  create: ({ study }) => createFacts(study),
};
