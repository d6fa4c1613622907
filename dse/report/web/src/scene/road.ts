// Lanes with the markings that the road's file gives, slippery areas: few meshes, whatever the road is like.
import {
  BufferGeometry,
  Float32BufferAttribute,
  Group,
  Mesh,
  MeshBasicMaterial,
  type Object3D,
  Shape,
  ShapeGeometry,
} from "three";
import { ROAD } from "./asphalt";
import type { Document, Marking, RoadKind, StandingObject, Strip } from "./data";
import { ALL_LIT, LIT, lit, painted } from "./light";
import { type Line, Ribbons, refined } from "./ribbons";

const ASPHALT = 0x66696e;
const WORN = 0x5e6166; // where wheels roll
const SURFACES: Record<string, number> = {
  shoulder: 0x7a7a76,
  stop: 0x63666b,
  border: 0x8b8a7c,
  sidewalk: 0xa9a59c,
  walking: 0xa9a59c,
  biking: 0x9a5f50,
  parking: 0x6f6f70,
  bus: 0x66696e,
  median: 0x7f9464,
  curb: 0xb8b6b0,
};
const VERGE = 0x8d9a74;
const COLOURS: Record<string, number> = {
  white: 0xe9e9e4,
  standard: 0xe9e9e4,
  yellow: 0xf0bd2c,
  orange: 0xf08a24,
  red: 0xc43b2f,
  blue: 0x3f6fc0,
  green: 0x3f8f5a,
};
const LANE = [0, 0.16, 0.27, 0.38, 0.5, 0.62, 0.73, 0.84, 1];
const TRACKS = new Set([0.27, 0.73]);
const DASHES: Record<RoadKind, [number, number]> = { motorway: [6, 12], rural: [4, 8], town: [3, 6] };
const MARK = lit(
  new MeshBasicMaterial({
    vertexColors: true,
    side: 2,
    polygonOffset: true,
    polygonOffsetFactor: -2,
    polygonOffsetUnits: -6,
  }),
  "",
  "mark",
);
ALL_LIT.push(MARK);

export function buildRoad(document: Document): Object3D {
  const group = new Group();
  const [lanes, beside] = [new Ribbons(), new Ribbons()];
  for (const { left, right, isDriven, kind } of document.strips) {
    if (isDriven) {
      // Wheels polish the asphalt and clear the snow.
      const columns = LANE.map((share) => ({
        share,
        colour: TRACKS.has(share) ? WORN : ASPHALT,
        free: TRACKS.has(share) ? 0.95 : 0.25,
      }));
      lanes.between(left, right, 0.02, columns);
    } else {
      const colour = SURFACES[kind] ?? VERGE;
      beside.between(
        left,
        right,
        kind === "sidewalk" ? 0.12 : 0.01,
        [0, 1].map((share) => ({ share, colour, free: 0.15 })),
      );
    }
  }
  group.add(lanes.group(ROAD));
  group.add(beside.group(ROAD));
  const marks = document.markings.length ? document.markings : usual(document.strips);
  const drawn = new Ribbons();
  const crossings = document.objects.filter(({ kind }) => kind === "crosswalk");
  const isFree = (x: number, y: number): boolean => !crossings.some((each) => isOn(each, x, y));
  for (const mark of marks) {
    const isNear = crossings.some(({ place: [x, y] }) => passes(mark.line, x, y));
    draw(isNear ? { ...mark, line: refined(mark.line, 0.5) } : mark, DASHES[document.kind], drawn, isFree);
  }
  group.add(drawn.group(MARK));
  for (const [outline, friction] of document.areas) group.add(slippery(outline, friction));
  return group;
}

/** Lit from above, whichever way round it is. */
export function laid(points: number[], corners: number[], colour: number): Mesh {
  const geometry = new BufferGeometry();
  const up = points.map((_, i) => (i % 3 === 2 ? 1 : 0));
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setAttribute("normal", new Float32BufferAttribute(up, 3));
  geometry.setIndex(corners);
  return new Mesh(painted(geometry, colour), LIT);
}

/** Whether *line* may come within *reach* m of a place. */
function passes(line: Line, x: number, y: number, reach = 30): boolean {
  for (let i = 0; i + 5 < line.length; i += 3) {
    const [dx, dy] = [line[i + 3]! - line[i]!, line[i + 4]! - line[i + 1]!];
    const middle = Math.hypot(line[i]! + dx / 2 - x, line[i + 1]! + dy / 2 - y);
    if (middle < reach + Math.hypot(dx, dy) / 2) return true;
  }
  return false;
}

/** Whether a place is on an object of the road's file. */
function isOn({ place: [x0, y0], heading, size: [length, width] }: StandingObject, x: number, y: number): boolean {
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  const [u, v] = [(x - x0) * c + (y - y0) * s, (y - y0) * c - (x - x0) * s];
  return Math.abs(u) < length / 2 && Math.abs(v) < width / 2;
}

/** Where it *isFree*. */
function draw(
  { line, kind, width, colour }: Marking,
  dash: [number, number],
  ribbons: Ribbons,
  isFree: (x: number, y: number) => boolean,
): void {
  const paint = COLOURS[colour] ?? COLOURS.white!;
  const parts = kind.split(" ").filter(Boolean);
  const lines = parts.length === 2 && parts.every((part) => /solid|broken/.test(part)) ? parts : [kind];
  lines.forEach((part, number) => {
    const aside = lines.length === 2 ? (number === 0 ? 1 : -1) * width : 0;
    const band = (piece: Line): void =>
      ribbons.along(
        piece,
        [aside + width / 2, aside - width / 2].map((left) => ({ left, up: 0.035, colour: paint, free: 0.45 })),
        isFree,
      );
    if (part === "curb") ribbons.along(line, kerb(1));
    else if (part === "botts dots") dashes(line, 0.15, 1.2, band);
    else if (part.startsWith("broken")) dashes(line, ...dash, band);
    else band(line);
  });
}

/** A kerb whose road is to the right of its line if *side* is 1. */
export function kerb(side: number): { left: number; up: number; colour: number; free: number }[] {
  const stone = 0xb4b1aa;
  return [
    [0, 0],
    [0.02, 0.12],
    [0.16, 0.12],
    [0.17, 0],
  ].map(([left, up]) => ({ left: side * left!, up: up!, colour: stone, free: 0.1 }));
}

function dashes(line: Line, on: number, off: number, band: (piece: Line) => void): void {
  let way = 0;
  for (let i = 0; i + 5 < line.length; i += 3) {
    const length = Math.hypot(line[i + 3]! - line[i]!, line[i + 4]! - line[i + 1]!);
    for (let at = -(way % (on + off)); at < length; at += on + off) {
      const [from, to] = [Math.max(at, 0), Math.min(at + on, length)];
      if (to <= from) continue;
      const point = (place: number): number[] =>
        [0, 1, 2].map((axis) => line[i + axis]! + (place / length) * (line[i + 3 + axis]! - line[i + axis]!));
      band([...point(from), ...point(to)]);
    }
    way += length;
  }
}

/** Where the file has none: solid lines at edges of what is driven on, dashes between lanes; none in junctions. */
function usual(strips: Strip[]): Marking[] {
  const borders = strips
    .filter((strip) => strip.isDriven && !strip.isInside)
    .flatMap((strip) => [strip.left, strip.right]);
  const shared = new Map<string, number>();
  for (const border of borders) for (const key of keysOf(border)) shared.set(key, (shared.get(key) ?? 0) + 1);
  const drawn = new Set<string>();
  return borders.flatMap((line) => {
    const keys = keysOf(line);
    const name = keys.join(" ");
    if (drawn.has(name)) return [];
    drawn.add(name);
    const isShared = keys.every((key) => shared.get(key)! > 1);
    return [{ line, kind: isShared ? "broken" : "solid", width: 0.15, colour: "white" }];
  });
}

/** Two lanes side by side have a border in common, in either direction. */
export function keysOf(border: Line): [string, string] {
  const key = (i: number): string => `${border[i]!.toFixed(1)},${border[i + 1]!.toFixed(1)}`;
  const middle = 3 * Math.floor(border.length / 6);
  const both = [key(0), key(border.length - 3)].sort();
  return [`${both[0]}~${both[1]}`, key(middle)];
}

/** Borders beside which there is no other lane, with their side of the strip: 1 for the left. */
export function outerBorders(strips: Strip[]): { line: Line; side: number; strip: Strip }[] {
  const sides = strips
    .filter(({ isInside }) => !isInside)
    .flatMap((strip) => [
      { line: strip.left, side: 1, strip },
      { line: strip.right, side: -1, strip },
    ]);
  const count = new Map<string, number>();
  const name = (line: Line): string => keysOf(line).join(" ");
  for (const { line } of sides) count.set(name(line), (count.get(name(line)) ?? 0) + 1);
  return sides.filter(({ line }) => count.get(name(line)) === 1);
}

function slippery(outline: number[], friction: number): Mesh {
  const shape = new Shape();
  for (let i = 0; i < outline.length; i += 2) {
    if (i === 0) shape.moveTo(outline[0]!, outline[1]!);
    else shape.lineTo(outline[i]!, outline[i + 1]!);
  }
  const ice = new MeshBasicMaterial({ color: 0xcfe8ff, transparent: true, opacity: Math.min(0.9, 1 - friction) });
  const mesh = new Mesh(new ShapeGeometry(shape), ice);
  mesh.position.z = 0.06;
  return mesh;
}
