// Lanes with their markings, slippery areas: few meshes, whatever the road is like.
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
import type { Document, Strip } from "./data";
import { LIT, painted } from "./light";

const ASPHALT = 0x70747a;
const VERGE = 0xa2a68e;
const WHITE = 0xf2f2ee;
const LINE = 0.15;
const DASH = 6;
const GAP = 6;

export function buildRoad(document: Document): Object3D {
  const group = new Group();
  group.add(
    surface(
      document.strips.filter((strip) => strip.isDriven),
      ASPHALT,
      0.02,
    ),
  );
  group.add(
    surface(
      document.strips.filter((strip) => !strip.isDriven),
      VERGE,
      0,
    ),
  );
  group.add(markings(document.strips));
  for (const [outline, friction] of document.areas) group.add(slippery(outline, friction));
  return group;
}

function surface(strips: Strip[], colour: number, lift: number): Mesh {
  const points: number[] = [];
  const corners: number[] = [];
  for (const { left, right } of strips) {
    const count = Math.min(left.length, right.length) / 3;
    const first = points.length / 3;
    for (let i = 0; i < count; i++) {
      points.push(left[3 * i]!, left[3 * i + 1]!, left[3 * i + 2]! + lift);
      points.push(right[3 * i]!, right[3 * i + 1]!, right[3 * i + 2]! + lift);
      if (i > 0) {
        const a = first + 2 * (i - 1);
        corners.push(a, a + 1, a + 2, a + 1, a + 3, a + 2);
      }
    }
  }
  return laid(points, corners, colour);
}

/** Lit from above, whichever way round it is. */
export function laid(points: number[], corners: number[], colour: number): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setAttribute(
    "normal",
    new Float32BufferAttribute(
      points.map((_, i) => (i % 3 === 2 ? 1 : 0)),
      3,
    ),
  );
  geometry.setIndex(corners);
  return new Mesh(painted(geometry, colour), LIT);
}

/** Solid lines at edges of what is driven on, dashes between lanes; none in junctions. */
function markings(strips: Strip[]): Mesh {
  const points: number[] = [];
  const corners: number[] = [];
  const driven = strips.filter((strip) => strip.isDriven && !strip.isInside);
  const borders = driven.flatMap((strip) => [strip.left, strip.right]);
  const shared = new Map<string, number>();
  for (const border of borders) for (const key of ends(border)) shared.set(key, (shared.get(key) ?? 0) + 1);
  const drawn = new Set<string>();
  for (const border of borders) {
    const name = ends(border).join(" ");
    if (drawn.has(name)) continue;
    drawn.add(name);
    ribbon(border, shared.get(ends(border)[0]!)! > 1 && shared.get(ends(border)[1]!)! > 1, points, corners);
  }
  return laid(points, corners, WHITE);
}

// Two lanes side by side have a border in common, in either direction.
function ends(border: number[]): string[] {
  const key = (i: number): string => `${border[i]!.toFixed(1)},${border[i + 1]!.toFixed(1)}`;
  const middle = 3 * Math.floor(border.length / 6);
  const both = [key(0), key(border.length - 3)].sort();
  return [`${both[0]}~${both[1]}`, key(middle)];
}

function ribbon(border: number[], dashed: boolean, points: number[], corners: number[]): void {
  let way = 0;
  for (let i = 0; i + 5 < border.length; i += 3) {
    const [x, y, z] = [border[i]!, border[i + 1]!, border[i + 2]!];
    const [dx, dy, dz] = [border[i + 3]! - x, border[i + 4]! - y, border[i + 5]! - z];
    const length = Math.hypot(dx, dy);
    if (length === 0) continue;
    const [nx, ny] = [(-dy / length) * (LINE / 2), (dx / length) * (LINE / 2)];
    const piece = (from: number, to: number): void => {
      const first = points.length / 3;
      for (const share of [from / length, to / length]) {
        const [px, py, pz] = [x + share * dx, y + share * dy, z + share * dz + 0.05];
        points.push(px + nx, py + ny, pz, px - nx, py - ny, pz);
      }
      corners.push(first, first + 1, first + 2, first + 1, first + 3, first + 2);
    };
    if (!dashed) piece(0, length);
    else {
      for (let at = -(way % (DASH + GAP)); at < length; at += DASH + GAP) {
        const [from, to] = [Math.max(at, 0), Math.min(at + DASH, length)];
        if (to > from) piece(from, to);
      }
    }
    way += length;
  }
}

function slippery(outline: number[], friction: number): Mesh {
  const shape = new Shape();
  for (let i = 0; i < outline.length; i += 2) {
    if (i === 0) shape.moveTo(outline[0]!, outline[1]!);
    else shape.lineTo(outline[i]!, outline[i + 1]!);
  }
  const ice = new MeshBasicMaterial({ color: 0xcfe8ff, transparent: true, opacity: Math.min(0.9, 1 - friction) });
  const mesh = new Mesh(new ShapeGeometry(shape), ice);
  mesh.position.z = 0.04;
  return mesh;
}
