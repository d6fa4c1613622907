// The findings of `dse findings`, as sentences under what they are about, plane by plane.
import { el } from "../../dom";
import { group } from "../../format";
import type { Told } from "../../insight";
import { type Store, studyThresholds } from "../../store";
import { planeName } from "../shared/planes";
import { isAsStudied } from "../shared/thresholds";

const WITHHELD = "withheld";

export function createFound(store: Store): HTMLElement {
  const { study } = store;
  const { told, withheld, drawn } = study.insight!;
  const note = el("p", { class: "hint", role: "status" });
  const explain = (): void => {
    note.textContent = isAsStudied(store.state.thresholds, studyThresholds(study))
      ? ""
      : "You have changed thresholds: these findings hold for the study\u2019s own thresholds.";
  };
  explain();
  store.subscribe((_, changed) => {
    if (changed.has("thresholds")) explain();
  });
  const planes = new Map<string, Told[]>();
  for (const each of told) {
    const key = each.plane.join();
    planes.set(key, [...(planes.get(key) ?? []), each]);
  }
  const box = el("div", { id: "findings" }, note);
  if (drawn)
    box.append(
      el("p", { class: "hint" }, `Of ${group(drawn)} runs drawn from all ${group(study.size)}: counts are theirs.`),
    );
  if (!told.length)
    box.append(
      el("p", { class: "sentence" }, study.size ? "The bench has no requirements." : "There are no runs yet."),
    );
  for (const those of planes.values()) {
    if (those[0]!.plane.length)
      box.append(el("h3", { class: "plane" }, `${planeName(study, those[0]!.plane)}; all else held`));
    box.append(
      ...topics(
        those.filter(({ topic }) => topic !== WITHHELD),
        those[0]!.plane.length ? "h4" : "h3",
      ),
    );
  }
  const silent = [...told.filter(({ topic }) => topic === WITHHELD).map(({ text }) => text), ...withheld];
  if (silent.length) {
    const list = el("ul", { class: "sentences" }, ...[...new Set(silent)].map((text) => el("li", {}, text)));
    box.append(
      el(
        "details",
        { id: "withheld" },
        el("summary", {}, `Withheld findings and reasons (${new Set(silent).size})`),
        list,
      ),
    );
  }
  return box;
}

function topics(those: Told[], level: "h3" | "h4"): HTMLElement[] {
  return [...new Set(those.map(({ topic }) => topic))].flatMap((topic) => [
    el(level, { class: "minor" }, topic),
    el(
      "ul",
      { class: "sentences" },
      ...those.filter((each) => each.topic === topic).map(({ text }) => el("li", {}, text)),
    ),
  ]);
}
