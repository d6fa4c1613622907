// What the colour of a point says: its verdict, a number along the ramp, or which alternative was chosen.
import { columnOf, type Keyed } from "../../columns";
import { axisLabel } from "../../study";
import { type Palette, palette, shade } from "../../theme";
import { choiceAt, differingPlaces, type Model } from "./model";
import { aggregated, designColumns } from "./values";

const SHADES = 64;
/** Alternatives with a colour of their own; the others share one. */
const MOST_COLOURS = 6;

export interface Colouring {
  /** One code per point, a place among `colours`; null for the verdict. */
  codes: Uint8Array | null;
  colours: string[];
  /** Alternatives by code. */
  names: string[];
  /** Ends of the ramp. */
  range: [number, number] | null;
  column: Keyed | null;
}

export function colourOptions(model: Model): [string, string][] {
  const { store } = model;
  return [
    ["verdict", "verdict"],
    ...differingPlaces(store).map((name): [string, string] => [`place.${name}`, `choice of ${name}`]),
    ...designColumns(store.study).map((column): [string, string] => [column.key, axisLabel(column)]),
  ];
}

export function colouringOf(model: Model, colours: Palette): Colouring {
  const { colour } = model.choices;
  if (colour.startsWith("place.")) return byChoice(model, colour.slice("place.".length), colours);
  const column = columnOf(model.store.study, colour);
  if (!column) return { codes: null, colours: [], names: [], range: null, column: null };
  const { points } = model.choices;
  const values =
    points === "runs" ? column.values : aggregated(model.store.study, column.values, model.column(colour).sense);
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  // What is undefined has a colour of its own, after the ramp.
  const codes = Uint8Array.from(values, (value) =>
    Number.isNaN(value)
      ? SHADES
      : Math.round((SHADES - 1) * (high > low ? Math.min(1, Math.max(0, (value - low) / (high - low))) : 0.5)),
  );
  const ramp = Array.from({ length: SHADES }, (_, code) => shade(colours.ramp, 0.12 + (0.88 * code) / (SHADES - 1)));
  return { codes, colours: [...ramp, colours.muted], names: [], range: high >= low ? [low, high] : null, column };
}

function byChoice(model: Model, name: string, colours: Palette): Colouring {
  const { store, grouping, choices } = model;
  const { study } = store;
  const chosen = study.configurations.map(
    (_, configuration) => choiceAt(store, configuration, name) || "\u2013 (none)",
  );
  const counts = new Map<string, number>();
  const sizes = new Int32Array(chosen.length);
  for (let run = 0; run < study.size; run++) sizes[study.configuration[run]!]!++;
  chosen.forEach((alternative, configuration) =>
    counts.set(alternative, (counts.get(alternative) ?? 0) + sizes[configuration]!),
  );
  const ranked = [...counts].sort((a, b) => b[1] - a[1]).map(([alternative]) => alternative);
  const named = ranked.length > MOST_COLOURS ? ranked.slice(0, MOST_COLOURS - 1) : ranked;
  const codeOf = chosen.map((alternative) => (named.includes(alternative) ? named.indexOf(alternative) : named.length));
  const runs = choices.points === "runs" ? null : grouping.first;
  const codes = new Uint8Array(runs ? grouping.size : study.size);
  for (let point = 0; point < codes.length; point++)
    codes[point] = codeOf[study.configuration[runs ? runs[point]! : point]!]!;
  const others = ranked.length > named.length ? [`${ranked.length - named.length} others`] : [];
  return {
    codes,
    colours: [...colours.requirements.slice(0, named.length), ...(others.length ? [colours.muted] : [])],
    names: [...named, ...others],
    range: null,
    column: null,
  };
}

/** That of the design at a place among those compared. */
export function seriesColour(index: number): string {
  const { requirements } = palette();
  return requirements[index % requirements.length]!;
}
