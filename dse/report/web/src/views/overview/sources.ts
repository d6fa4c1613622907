// The study's files as they were run, with their hashes.
import { el } from "../../dom";
import type { Study } from "../../study";

export function createSources(study: Study): HTMLElement {
  const { notes } = study;
  if (!notes?.sources.length)
    return el(
      "p",
      { class: "hint", id: "sources" },
      "Its files are not kept with this study: it was made by an earlier version of dse, or of a package. \u2018dse explore\u2019 of the same study keeps them.",
    );
  return el(
    "div",
    { id: "sources" },
    ...notes.sources.map(({ kind, file, text, digest }) =>
      el(
        "details",
        { class: "source" },
        el("summary", {}, el("b", {}, file), ` (${kind})`),
        el("p", { class: "hint" }, "SHA-256 ", el("code", {}, digest)),
        el("pre", { tabindex: 0, role: "region", "aria-label": `${kind} ${file}`, dir: "ltr" }, text),
      ),
    ),
    el(
      "p",
      { class: "hint" },
      "As they were when the study was last explored. Components are identified by the hashes of their FMUs, below.",
    ),
  );
}
