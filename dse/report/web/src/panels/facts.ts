// Where the numbers come from: hashes, versions, seed, sampler, and how exact this page is.
import { el } from "../dom";
import type { Study } from "../study";

export function createFacts(study: Study): HTMLElement {
  const list = el("dl", { class: "facts" });
  for (const [key, value] of study.facts) list.append(el("dt", {}, key), el("dd", {}, value));
  return el("details", { class: "card", id: "facts" }, el("summary", {}, "Study facts"), list);
}
