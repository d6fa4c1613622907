// Beside the lanes: shoulders, kerbs with pavements, guard rails, slopes down to the land, posts; and zebra crossings.
import { Group, type Object3D } from "three";
import { ROAD } from "./asphalt";
import type { Document, RoadKind, StandingObject } from "./data";
import { LIT } from "./light";
import { acrossOf, type Edge, type Line, Ribbons, refined } from "./ribbons";
import { kerb, outerBorders } from "./road";
import type { RoadMap } from "./roadmap";

const GRAVEL = 0x9a9586;
const PAVED = 0x6d7075;
const FLAGS = 0xb3aea4;
const GRASS = 0x839b58;
const STEEL = 0xb4bcc2;
const PAVEMENT = 2.4;
/** m from the border of the lanes to the rail. */
export const RAIL = 1.5;
const PAINT = 0xe9e9e4;

export function buildRoadside(document: Document, roads: RoadMap): Object3D {
  const group = new Group();
  const [ground, steel] = [new Ribbons(), new Ribbons()];
  for (const { line, side, strip } of outerBorders(document.strips)) {
    const fine = refined(line, 9);
    const own = document.strips.indexOf(strip);
    // Nothing beside one road lies on another.
    const isFree =
      (aside: number) =>
      (x: number, y: number, i: number): boolean => {
        const [nx, ny] = acrossOf(fine, i);
        return roads.nearest(x + side * aside * nx, y + side * aside * ny, own).gap > -0.3;
      };
    const paved = strip.kind === "sidewalk" || strip.kind === "walking";
    for (const { section, reach } of sections(document.kind, side, paved, strip.isDriven))
      ground.along(fine, section, isFree(reach));
    if (document.kind === "motorway") rail(fine, side * (strip.isDriven ? RAIL : 0.5), steel, isFree(RAIL));
  }
  for (const each of document.objects) if (each.kind === "crosswalk") zebra(each, ground);
  group.add(ground.group(ROAD), steel.group(LIT));
  return group;
}

/** Cross-sections from the border outwards, and how far they reach. */
function sections(
  kind: RoadKind,
  side: number,
  paved: boolean,
  isDriven: boolean,
): { section: Edge[]; reach: number }[] {
  const edge = (left: number, up: number, colour: number, free = 0): Edge => ({ left: side * left, up, colour, free });
  const slope = (from: number, up: number): Edge[] => [
    edge(from, up, GRASS),
    edge(from + 1.6, up - 0.35, GRASS),
    edge(from + 5, -1.6, GRASS),
  ];
  if (kind === "town" && isDriven) {
    const flags = [edge(0.16, 0.12, FLAGS), edge(PAVEMENT, 0.14, FLAGS)];
    return [
      { section: kerb(side), reach: 0.6 },
      { section: flags, reach: PAVEMENT },
      { section: slope(PAVEMENT, 0.14), reach: PAVEMENT + 2 },
    ];
  }
  if (kind === "town") return [{ section: slope(0, paved ? 0.12 : 0), reach: 2 }];
  const bed = kind === "motorway" && isDriven ? 1.1 : isDriven ? 0.35 : 0;
  const asphalt = bed
    ? [{ section: [edge(0, 0.015, PAVED, 0.1), edge(bed, -0.01, PAVED, 0.1)], reach: bed + 0.3 }]
    : [];
  return [
    ...asphalt,
    { section: [edge(bed, -0.01, GRAVEL), edge(bed + 0.7, -0.06, GRAVEL)], reach: bed + 0.7 },
    { section: slope(bed + 0.7, -0.06), reach: bed + 3 },
  ];
}

/** A W-beam, and posts as thin bands every 4 m. */
function rail(line: Line, aside: number, steel: Ribbons, keep: (x: number, y: number, i: number) => boolean): void {
  const out = Math.sign(aside);
  const beam = [
    [0, 0.45],
    [-0.05, 0.51],
    [0, 0.59],
    [-0.05, 0.67],
    [0, 0.74],
  ].map(([left, up]) => ({ left: aside + out * left!, up: up!, colour: STEEL, free: 0.6 }));
  steel.along(line, beam, keep);
  for (let i = 0; i + 5 < line.length; i += 3) {
    if (!keep(line[i]!, line[i + 1]!, i / 3)) continue;
    const [dx, dy] = [line[i + 3]! - line[i]!, line[i + 4]! - line[i + 1]!];
    const length = Math.hypot(dx, dy) || 1;
    const piece = [0, 0.1].flatMap((m) => [
      line[i]! + (m * dx) / length,
      line[i + 1]! + (m * dy) / length,
      line[i + 2]!,
    ]);
    steel.along(
      piece,
      [0, 0.6].map((up) => ({ left: aside + out * 0.06, up: up - 0.1, colour: 0x8d959b, free: 0.6 })),
    );
  }
}

/** Stripes along the way of the vehicles, across that of the walkers. */
function zebra({ place: [x, y, z], heading, size: [length, width] }: StandingObject, ribbons: Ribbons): void {
  // OpenDRIVE has the length along the object's own x, across which the road is crossed where it is the longer one.
  const [walk, wide, along] =
    length >= width ? [length || 8, width || 3, heading] : [width, length || 3, heading + Math.PI / 2];
  const [c, s] = [Math.cos(along), Math.sin(along)];
  for (let at = -walk / 2 + 0.25; at + 0.5 <= walk / 2; at += 1) {
    const point = (u: number, v: number): number[] => [x + u * c - v * s, y + u * s + v * c, z];
    const [near, far] = [point(at + 0.25, -wide / 2), point(at + 0.25, wide / 2)];
    ribbons.along(
      [...near, ...far],
      [0.25, -0.25].map((left) => ({ left, up: 0.05, colour: PAINT, free: 0.4 })),
    );
  }
}
