// The design nearest to one that is out, among those that are not.

import { type Grouping, variablesOf } from "../../grouping";
import type { Study } from "../../study";

export interface Change {
  title: string;
  from: string;
  to: string;
  /** Of a design variable: by which share of its range; NaN for a choice. */
  share: number;
}

/** The one *among*, 1 for each, with the fewest changed choices, then the shortest way in the design variables, each in
 * units of its range; -1 if there is none. *stay* admits no other configuration. */
export function nearestDesign(
  study: Study,
  { size, first }: Grouping,
  design: number,
  among: Uint8Array,
  stay: boolean,
): number {
  const run = first[design]!;
  const variables = variablesOf(study, "design");
  const own = study.configuration[run]!;
  const changed = study.configurations.map((_, other) => changedPlaces(study, own, other).length);
  let best = -1;
  let fewest = Infinity;
  let shortest = Infinity;
  for (let other = 0; other < size; other++) {
    if (!among[other] || other === design) continue;
    const there = first[other]!;
    const configuration = study.configuration[there]!;
    const changes = changed[configuration]!;
    if (changes > fewest || (stay && configuration !== own)) continue;
    let way = 0;
    for (const { values, low, high, lack } of variables) {
      if (lack.includes(own) || lack.includes(configuration)) continue;
      way += ((values[run]! - values[there]!) / (high - low)) ** 2;
    }
    if (changes === fewest && way >= shortest) continue;
    [best, fewest, shortest] = [other, changes, way];
  }
  return best;
}

/** What becomes other from one design to another: choices in their order, then variables, the largest way first. */
export function changesBetween(study: Study, { first }: Grouping, from: number, to: number): Change[] {
  const [a, b] = [first[from]!, first[to]!];
  const [own, other] = [study.configuration[a]!, study.configuration[b]!];
  const chosen = [own, other].map((configuration) => new Map(study.configurations[configuration]!.choices));
  const choices = changedPlaces(study, own, other).map(
    (name): Change => ({
      title: name,
      from: chosen[0]!.get(name) ?? "\u2013",
      to: chosen[1]!.get(name) ?? "\u2013",
      share: NaN,
    }),
  );
  const variables = variablesOf(study, "design").flatMap(({ title, unit, values, text, low, high, lack }): Change[] => {
    const [had, has] = [!lack.includes(own), !lack.includes(other)];
    if ((!had && !has) || (had && has && values[a] === values[b])) return [];
    const say = (known: boolean, run: number): string =>
      known ? `${text(values[run]!)}${unit ? `\u202f${unit}` : ""}` : "\u2013";
    return [
      { title, from: say(had, a), to: say(has, b), share: had && has ? (values[b]! - values[a]!) / (high - low) : NaN },
    ];
  });
  variables.sort((p, q) => Math.abs(q.share) - Math.abs(p.share));
  return [...choices, ...variables];
}

function changedPlaces(study: Study, one: number, other: number): string[] {
  if (one === other) return [];
  const [a, b] = [one, other].map((configuration) => new Map(study.configurations[configuration]!.choices)) as [
    Map<string, string>,
    Map<string, string>,
  ];
  return [...new Set([...a.keys(), ...b.keys()])].filter((name) => a.get(name) !== b.get(name));
}
