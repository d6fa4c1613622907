// What was studied, and where the numbers come from.
import { createFacts } from "../panels/facts";
import type { View } from "./view";

export const studyView: View = {
  name: "study",
  title: "Study",
  suits: () => true,
  create: ({ study }) => createFacts(study),
};
