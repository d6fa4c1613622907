// What the requirements leave of the plane: hatched where one fails, blank where one was not exercised.
import { scaleLinear } from "d3-scale";
import type { Fields } from "../plane/fields";
import type { Study } from "../study";
import { type Palette, shade } from "../theme";
import type { Threshold } from "../verdicts";
import { above, below, outside, path, type Ring } from "./contour";
import { clipTo, type Frame } from "./frame";
import { hatch } from "./hatch";
import type { Pen } from "./pen";

/** Where a requirement's metric is beyond one of its bounds. */
export interface Side {
  requirement: number;
  limit: number;
  rings: Ring[];
}

export interface Regions {
  sides: Side[];
  /** Per requirement, where the runs do not exercise it. */
  open: Ring[][];
  /** Where failed runs leave a hole. */
  unknown: Ring[];
}

export interface Scale {
  domain: [number, number];
  steps: number[];
}

export function regionsOf(study: Study, fields: Fields, thresholds: Threshold[], frame: Frame): Regions {
  const isOn = (requirement: number): boolean => !thresholds[requirement]!.off;
  const known = fields.known(study.requirements.map((_, index) => index).filter(isOn));
  return {
    sides: study.requirements.flatMap(({ metric }, requirement) => {
      if (!isOn(requirement)) return [];
      const { atMost, atLeast } = thresholds[requirement]!;
      const sides: Side[] = [];
      if (atMost !== null)
        sides.push({
          requirement,
          limit: atMost,
          rings: above(fields.metric(metric, "max", requirement), fields, frame, atMost),
        });
      if (atLeast !== null)
        sides.push({
          requirement,
          limit: atLeast,
          rings: below(fields.metric(metric, "min", requirement), fields, frame, atLeast),
        });
      return sides;
    }),
    open: study.requirements.map((_, index) => {
      const exercised = isOn(index) ? fields.exercised(index) : null;
      return exercised ? below(exercised, fields, frame, 0.5) : [];
    }),
    unknown: known ? below(known, fields, frame, 0.5) : [],
  };
}

/** Even steps over the bulk of a metric's values: a few wild runs do not wash out the colours. */
export function scaleOf(values: Float64Array, runs: Int32Array): Scale {
  const sorted = Float64Array.from(runs, (run) => values[run]!)
    .filter(Number.isFinite)
    .sort();
  if (!sorted.length) return { domain: [0, 1], steps: [0, 1] };
  const at = (share: number): number => sorted[Math.round(share * (sorted.length - 1))]!;
  let [low, high] = [at(0.02), at(0.98)];
  if (high - low < 1e-12 * Math.max(1, Math.abs(low))) [low, high] = [low - 0.5, high + 0.5];
  const nice = scaleLinear([low, high], [0, 1]).nice(10);
  const domain = nice.domain() as [number, number];
  return { domain, steps: nice.ticks(10) };
}

export function paintRegions(
  pen: Pen,
  frame: Frame,
  fields: Fields,
  regions: Regions,
  fill: { values: Float64Array; scale: Scale } | null,
  colours: Palette,
): void {
  pen.save();
  clipTo(pen, frame);
  if (fill) paintBands(pen, frame, fields, fill.values, fill.scale, colours);
  else paintAll(pen, frame, colours.feasible);
  const failing = path(regions.sides.flatMap(({ rings }) => rings));
  pen.fillStyle = fill ? colours.veil : colours.plot;
  pen.fill(failing);
  const blank = path([...regions.open.flat(), ...regions.unknown]);
  pen.fillStyle = colours.plot;
  pen.fill(blank);
  for (const { requirement, rings } of regions.sides) {
    if (!rings.length) continue;
    pen.save();
    pen.clip(outside(regions.open[requirement]!), "evenodd");
    pen.clip(outside(regions.unknown), "evenodd");
    const colour = colourOf(colours, requirement);
    const shape = path(rings);
    pen.globalAlpha = 0.62;
    pen.fillStyle = hatch(pen, requirement, colour);
    pen.fill(shape);
    pen.globalAlpha = 1;
    pen.strokeStyle = colours.plot;
    pen.lineWidth = 5;
    pen.stroke(shape);
    pen.strokeStyle = colour;
    pen.lineWidth = 2.4;
    pen.stroke(shape);
    pen.restore();
  }
  pen.setLineDash([6, 4]);
  pen.lineWidth = 1.4;
  pen.strokeStyle = colours.muted;
  for (const rings of merged(regions.open)) pen.stroke(path(rings));
  pen.setLineDash([2, 3]);
  pen.stroke(path(regions.unknown));
  pen.restore();
}

export function colourOf(colours: Palette, index: number): string {
  return colours.requirements[index % colours.requirements.length]!;
}

/** Requirements that leave the same region open, so that it is drawn and named once. */
export function sameOpen(open: Ring[][]): number[][] {
  const groups = new Map<string, number[]>();
  open.forEach((rings, index) => {
    if (!rings.length) return;
    const key = `${rings.length}:${rings.map((ring) => `${ring.length},${ring[0]!.join()}`).join(";")}`;
    groups.set(key, [...(groups.get(key) ?? []), index]);
  });
  return [...groups.values()];
}

function merged(open: Ring[][]): Ring[][] {
  return sameOpen(open).map(([first]) => open[first!]!);
}

function paintBands(
  pen: Pen,
  frame: Frame,
  fields: Fields,
  values: Float64Array,
  { domain, steps }: Scale,
  colours: Palette,
): void {
  paintAll(pen, frame, bandColour(colours, 0, steps.length));
  steps.slice(1).forEach((step, index) => {
    pen.fillStyle = bandColour(colours, index + 1, steps.length);
    if (step <= domain[1]) pen.fill(path(above(values, fields, frame, step)));
  });
}

/** Colour of the band that starts at step `index`. */
export function bandColour(colours: Palette, index: number, steps: number): string {
  return shade(colours.ramp, index / Math.max(1, steps - 1));
}

function paintAll(pen: Pen, { left, right, top, bottom }: Frame, colour: string): void {
  pen.fillStyle = colour;
  pen.fillRect(left, top, right - left, bottom - top);
}
