// Closed bodies from cross-sections: rings of points, one behind the other along x, with a face at both ends.
import { BufferGeometry, Color, Float32BufferAttribute, Vector3 } from "three";
import { toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";
import type { Surface } from "../light";

/** Half of a cross-section, from the middle of its bottom to the middle of its top: y >= 0, z. */
export type HalfRing = [y: number, z: number][];

export interface Station {
  x: number;
  half: HalfRing;
}

/** Colour and surface of a face between stations `at` and `at + 1`, and points `strip` and `strip + 1` of half a ring. */
export type Paint = (at: number, strip: number) => [colour: number, surface: Surface];

const CREASE = 0.6; // rad between faces that are seen as one

/** The body through *stations*, from the rear to the front; all of them have equally many points. */
export function loft(stations: Station[], paint: Paint, crease = CREASE): BufferGeometry {
  const rings = stations.map(({ x, half }) => {
    const mirrored = half.slice(1, -1).reverse();
    return [...half.map(([y, z]) => [x, y, z]), ...mirrored.map(([y, z]) => [x, -y, z])] as [number, number, number][];
  });
  const strips = stations[0]!.half.length - 1;
  const around = 2 * strips;
  const faces = new Faces();
  for (let at = 0; at + 1 < rings.length; at++) {
    for (let i = 0; i < around; i++) {
      const j = (i + 1) % around;
      const [behind, ahead] = [rings[at]!, rings[at + 1]!];
      const [colour, surface] = paint(at, i < strips ? i : around - 1 - i);
      faces.quad(behind[i]!, behind[j]!, ahead[j]!, ahead[i]!, colour, surface);
    }
  }
  for (const end of [0, rings.length - 1]) {
    const ring = rings[end]!;
    const [colour, surface] = paint(end ? end - 1 : 0, -1);
    for (let i = 0; i < strips; i++) {
      // Between a point and its mirror image: i from the bottom up.
      const [left, above] = [ring[i]!, ring[i + 1]!];
      const mirror = (k: number): [number, number, number] => ring[(around - k) % around]!;
      const corners = [left, mirror(i), mirror(i + 1), above] as const;
      const [a, b, c, d] = end ? [corners[3], corners[2], corners[1], corners[0]] : corners;
      faces.quad(a, b, c, d, colour, surface);
    }
  }
  return faces.geometry(crease);
}

type Point = [number, number, number];

/** Triangles with a colour and a surface each; those without an area are left out. */
export class Faces {
  private readonly points: number[] = [];
  private readonly colours: number[] = [];
  private readonly surfaces: number[] = [];

  quad(a: Point, b: Point, c: Point, d: Point, colour: number, surface: Surface): void {
    this.triangle(a, b, c, colour, surface);
    this.triangle(a, c, d, colour, surface);
  }

  triangle(a: Point, b: Point, c: Point, colour: number, surface: Surface): void {
    if (same(a, b) || same(b, c) || same(a, c)) return;
    const { r, g, b: blue } = new Color(colour);
    for (const point of [a, b, c]) {
      this.points.push(...point);
      this.colours.push(r, g, blue);
      this.surfaces.push(...surface);
    }
  }

  geometry(crease: number): BufferGeometry {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(this.points, 3));
    geometry.computeVertexNormals();
    const smooth = toCreasedNormals(geometry, crease);
    smooth.setAttribute("color", new Float32BufferAttribute(this.colours, 3));
    smooth.setAttribute("surface", new Float32BufferAttribute(this.surfaces, 2));
    return smooth;
  }
}

function same(a: Point, b: Point): boolean {
  return Math.abs(a[0] - b[0]) + Math.abs(a[1] - b[1]) + Math.abs(a[2] - b[2]) < 1e-6;
}

/** Edges of triangles that have no neighbour, or more than one: 0 for a closed body. */
export function openEdges(geometry: BufferGeometry): number {
  const points = geometry.getAttribute("position");
  const names = new Map<string, number>();
  const corner = (i: number): number => {
    const name = [points.getX(i), points.getY(i), points.getZ(i)].map((value) => Math.round(value * 1e4)).join();
    const known = names.get(name) ?? names.size;
    names.set(name, known);
    return known;
  };
  const edges = new Map<string, number>();
  for (let i = 0; i < points.count; i += 3) {
    const three = [corner(i), corner(i + 1), corner(i + 2)];
    if (new Set(three).size < 3) continue;
    for (let k = 0; k < 3; k++) {
      const [from, to] = [three[k]!, three[(k + 1) % 3]!];
      const [name, way] = from < to ? [`${from} ${to}`, 1] : [`${to} ${from}`, -1];
      edges.set(name, (edges.get(name) ?? 0) + way);
    }
  }
  return [...edges.values()].filter((sum) => sum !== 0).length;
}

/** m³ inside a closed body; negative if its faces look inwards. */
export function volume(geometry: BufferGeometry): number {
  const points = geometry.getAttribute("position");
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  let sum = 0;
  for (let i = 0; i < points.count; i += 3) {
    a.fromBufferAttribute(points, i);
    b.fromBufferAttribute(points, i + 1);
    c.fromBufferAttribute(points, i + 2);
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}
