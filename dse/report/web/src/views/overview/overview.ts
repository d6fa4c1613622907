// The first page of a report as one would read it: what must be known before, what was found, what was asked.
import { card, el } from "../../dom";
import { createFacts } from "../../panels/facts";
import type { View } from "../view";
import { createChoice } from "./choice";
import { createConstants } from "./constants";
import { createFound } from "./findings";
import { createFormulas } from "./formulas";
import { createPicks } from "./picks";
import { createAsked } from "./question";
import { createRequirements } from "./requirements";
import { createSources } from "./sources";
import { createWarnings } from "./warnings";

export const overviewView: View = {
  name: "overview",
  title: "Overview",
  suits: ({ insight }) => insight !== null,
  create(store) {
    const { study } = store;
    const { asked } = study.insight!;
    const facts = createFacts(study);
    facts.setAttribute("open", "");
    const requirements = study.requirements.length ? [card("lights", "Requirements", createRequirements(store))] : [];
    return el(
      "div",
      { class: "overview-page" },
      ...createChoice(store),
      card("warnings", "Before you rely on it", createWarnings(store)),
      el(
        "div",
        { class: "overview-columns" },
        el(
          "div",
          {},
          ...requirements,
          card("picks", "Runs to look at", createPicks(store)),
          card("found", "What was found", createFound(store)),
        ),
        el(
          "div",
          {},
          card("asked", "What was asked", createAsked(study, asked)),
          card("measured", "How it was measured", createFormulas(study, asked)),
          createConstants(asked),
          card("files", "Files as they were run", createSources(study)),
          facts,
        ),
      ),
    );
  },
};
