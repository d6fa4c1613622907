// Which part of the plane is shown: never more than all of it.
import type { Plane } from "../plane/plane";
import type { Zoom } from "../store";
import type { Study } from "../study";

type Range = readonly [number, number];

const MOST = 200;

/** The whole plane, in the units of its axes. */
export function wholeOf(study: Study, { x, y }: Pick<Plane, "x" | "y">): Zoom {
  const range = (index: number): Range => [study.variables[index]!.low, study.variables[index]!.high];
  return { x: range(x), y: range(y) };
}

/** *shown* enlarged by *factor* about a place in it, which stays where it is; null once all is shown. */
export function zoomedBy(whole: Zoom, shown: Zoom, factor: number, at: readonly [number, number]): Zoom | null {
  const scaled = ([low, high]: Range, [least, most]: Range, place: number): Range => {
    const width = Math.max((most - least) / MOST, (high - low) / factor);
    const from = place - ((place - low) / (high - low)) * width;
    return inside([from, from + width], [least, most]);
  };
  return partOf(whole, { x: scaled(shown.x, whole.x, at[0]), y: scaled(shown.y, whole.y, at[1]) });
}

/** *shown* moved by a part of its own width and height. */
export function movedBy(whole: Zoom, shown: Zoom, dx: number, dy: number): Zoom | null {
  const moved = ([low, high]: Range, limits: Range, share: number): Range => {
    const by = share * (high - low);
    return inside([low + by, high + by], limits);
  };
  return partOf(whole, { x: moved(shown.x, whole.x, dx), y: moved(shown.y, whole.y, dy) });
}

function inside([low, high]: Range, [least, most]: Range): Range {
  if (high - low >= most - least) return [least, most];
  const by = low < least ? least - low : high > most ? most - high : 0;
  return [low + by, high + by];
}

function partOf(whole: Zoom, shown: Zoom): Zoom | null {
  const isWhole = (key: "x" | "y"): boolean =>
    shown[key][1] - shown[key][0] >= (1 - 1e-9) * (whole[key][1] - whole[key][0]);
  return isWhole("x") && isWhole("y") ? null : shown;
}
