// What signs and hatches of the constraint plot mean, for pictures that are saved; on the page other panels say it.
import { countMarks, shownRuns, thresholdsHere } from "../counts";
import { number, withUnit } from "../format";
import type { Store } from "../store";
import { palette } from "../theme";
import { type Mark, wordFor } from "../verdicts";
import type { Frame } from "./frame";
import { drawSwatch } from "./hatch";
import { type Entry, markEntry, SIGN } from "./legend";
import { colourOf, regionsOf } from "./regions";

export function plotLegend(store: Store, frame: Frame): Entry[] {
  const { study, state } = store;
  const { judgement, noun } = store.points();
  const counts = countMarks(judgement.overall, shownRuns(store), null);
  const marks = ([0, 1, 2, 3] as Mark[])
    .filter((mark) => counts[mark])
    .map((mark) => markEntry(mark, wordFor(mark, noun)));
  const { fields } = store.plane();
  const seen = new Set(
    fields
      ? regionsOf(study, fields, thresholdsHere(store), frame)
          .sides.filter(({ rings }) => rings.length)
          .map(({ requirement }) => requirement)
      : [],
  );
  const hatches = study.requirements.flatMap(({ title, metric }, index): Entry[] => {
    const { atMost, atLeast } = state.thresholds[index]!;
    const { title: name, unit } = study.metrics[metric]!;
    const bounds = [
      atLeast === null ? "" : `\u2265 ${withUnit(number(atLeast), unit)}`,
      atMost === null ? "" : `\u2264 ${withUnit(number(atMost), unit)}`,
    ]
      .filter(Boolean)
      .join(", ");
    const draw: Entry["draw"] = (pen, x, y) => {
      pen.translate(x - SIGN / 2, y - SIGN / 2);
      drawSwatch(pen, SIGN, index, colourOf(palette(), index));
    };
    // Hatched is what misses it.
    return !seen.has(index) ? [] : [{ text: `misses \u201c${title}\u201d: ${name} ${bounds}`, draw }];
  });
  return [...marks, ...hatches];
}
