// What is kept with a study besides its runs, as dse/report/page/provenance.py has it: the fields are called the same.
import { shortened } from "./format";

const MOST_NAME = 80;
const MOST_SENTENCE = 600;

export interface SourceText {
  kind: string;
  file: string;
  text: string;
  digest: string;
}

/** What a static constraint and those before it leave: about `count`, as `text` has it. */
export interface Left {
  constraint: string;
  because: string;
  rule: string;
  count: number;
  text: string;
}

export interface Funnel {
  design: string;
  count: number;
  text: string;
  steps: Left[];
  absent: { place: string; choice: string; constraints: string[] }[];
}

export interface Notes {
  sources: SourceText[];
  funnel: Funnel | null;
  unfunnelled: string;
  /** Parameters that components mark as assumed, as `component.parameter`; null if that was not kept. */
  assumed: string[] | null;
}

/** Tries that were made again, by what they came to: so many runs, and the first of them. */
export interface Retried {
  cause: string;
  count: number;
  runs: number[];
}

export function readNotes(notes: Notes | null | undefined): Notes | null {
  if (!notes) return null;
  const name = (text: string): string => shortened(text, MOST_NAME);
  const said = (text: string): string => shortened(text, MOST_SENTENCE);
  const { funnel } = notes;
  return {
    sources: notes.sources.map((each) => ({ ...each, file: name(each.file) })),
    unfunnelled: said(notes.unfunnelled),
    assumed: notes.assumed ?? null,
    funnel: funnel && {
      ...funnel,
      design: name(funnel.design),
      steps: funnel.steps.map((each) => ({
        ...each,
        constraint: name(each.constraint),
        because: said(each.because),
        rule: said(each.rule),
      })),
      absent: funnel.absent.map((each) => ({
        place: name(each.place),
        choice: name(each.choice),
        constraints: each.constraints.map(name),
      })),
    },
  };
}

export function readRetried(retried: Retried[] | undefined): Retried[] {
  return (retried ?? []).map((each) => ({ ...each, cause: shortened(each.cause, MOST_SENTENCE) }));
}
