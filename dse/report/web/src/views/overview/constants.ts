// Parameters of the bench and its components that no run changed.
import { el } from "../../dom";
import { number } from "../../format";
import type { Asked } from "../../insight";

export function createConstants(asked: Asked): HTMLElement | null {
  if (!asked.constants.length) return null;
  const list = el("dl", { class: "facts" });
  for (const [name, value] of asked.constants) list.append(el("dt", {}, name), el("dd", {}, number(value, 6)));
  const rest = asked.differing ? ` ${asked.differing} others differ between configurations.` : "";
  return el(
    "details",
    { class: "card", id: "constants" },
    el("summary", {}, `Bench parameters (${asked.constants.length})`),
    el("p", { class: "hint" }, `The same in every run, in SI units.${rest}`),
    list,
  );
}
