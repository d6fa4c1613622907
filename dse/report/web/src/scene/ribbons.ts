// Bands along lines: lanes, markings, kerbs, rails and slopes are such, collected into one mesh each.
import { BufferGeometry, Color, Float32BufferAttribute, Group, Mesh, type MeshBasicMaterial } from "three";
import { LIT } from "./light";

export type Line = number[]; // x, y, z of each point

/** A point of a band's cross-section: m to the left of the line, m above it, its colour, how much snow is driven away. */
export interface Edge {
  left: number;
  up: number;
  colour: number;
  free?: number;
}

const CELL = 900; // m: what is drawn, or left out, together

/** One after another, so that what is out of sight costs nothing. */
export class Ribbons {
  private readonly pieces = new Map<string, Piece>();

  /** The band with *section* along *line*; *keep* says where it is left out, by place. */
  along(line: Line, section: Edge[], keep?: (x: number, y: number, at: number) => boolean): void {
    this.each(line, (piece, from, to) => {
      for (let i = from; i <= to; i++) {
        const [nx, ny] = acrossOf(line, i);
        section.forEach(({ left, up, colour, free }, k) => {
          piece.point(line[3 * i]! + nx * left, line[3 * i + 1]! + ny * left, line[3 * i + 2]! + up, colour, free ?? 0);
          const [before, after] = [section[Math.max(k - 1, 0)]!, section[Math.min(k + 1, section.length - 1)]!];
          const [run, rise] = [after.left - before.left, after.up - before.up];
          const size = Math.hypot(run, rise) || 1;
          const sign = run < 0 || (run === 0 && rise > 0) ? -1 : 1;
          piece.normal((-sign * rise * nx) / size, (-sign * rise * ny) / size, Math.abs(run) / size);
        });
      }
      piece.rows(section.length, to - from, (row) => {
        const i = from + row;
        return !keep || keep(line[3 * i]!, line[3 * i + 1]!, i);
      });
    });
  }

  /** The band between two lines of equally many points, with *columns* in between at shares from left (0) to right. */
  between(left: Line, right: Line, lift: number, columns: { share: number; colour: number; free: number }[]): void {
    const shorter = left.length < right.length ? left : right;
    this.each(shorter, (piece, from, to) => {
      for (let i = from; i <= to; i++) {
        for (const { share, colour, free } of columns) {
          const at = (axis: number): number =>
            left[3 * i + axis]! + share * (right[3 * i + axis]! - left[3 * i + axis]!);
          piece.point(at(0), at(1), at(2) + lift, colour, free);
          piece.normal(0, 0, 1);
        }
      }
      piece.rows(columns.length, to - from, () => true);
    });
  }

  group(material: MeshBasicMaterial = LIT): Group {
    const group = new Group();
    for (const piece of this.pieces.values()) group.add(piece.mesh(material));
    return group;
  }

  /** Calls *use* for each part of *line*, from its point `from` to `to`, that is in one cell. */
  private each(line: Line, use: (piece: Piece, from: number, to: number) => void): void {
    const count = line.length / 3;
    const cellOf = (i: number): string => `${Math.floor(line[3 * i]! / CELL)} ${Math.floor(line[3 * i + 1]! / CELL)}`;
    for (let from = 0; from + 1 < count; ) {
      const cell = cellOf(from);
      let to = from + 1;
      while (to + 1 < count && cellOf(to) === cell) to++;
      let piece = this.pieces.get(cell);
      if (!piece) {
        piece = new Piece();
        this.pieces.set(cell, piece);
      }
      use(piece, from, to);
      from = to;
    }
  }
}

class Piece {
  private readonly points: number[] = [];
  private readonly normals: number[] = [];
  private readonly colours: number[] = [];
  private readonly surfaces: number[] = [];
  private readonly corners: number[] = [];

  point(x: number, y: number, z: number, colour: number, free: number): void {
    const { r, g, b } = shade.set(colour);
    this.points.push(x, y, z);
    this.colours.push(r, g, b);
    this.surfaces.push(free, 0);
  }

  normal(x: number, y: number, z: number): void {
    this.normals.push(x, y, z);
  }

  /** Faces between the last *count* + 1 rows of *width* points, where *isKept*. */
  rows(width: number, count: number, isKept: (row: number) => boolean): void {
    const start = this.points.length / 3 - (count + 1) * width;
    for (let row = 0; row < count; row++) {
      if (!isKept(row)) continue;
      for (let k = 0; k + 1 < width; k++) {
        const [a, b] = [start + row * width + k, start + (row + 1) * width + k];
        this.corners.push(a, a + 1, b, a + 1, b + 1, b);
      }
    }
  }

  mesh(material: MeshBasicMaterial): Mesh {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(this.points, 3));
    geometry.setAttribute("normal", new Float32BufferAttribute(this.normals, 3));
    geometry.setAttribute("color", new Float32BufferAttribute(this.colours, 3));
    geometry.setAttribute("surface", new Float32BufferAttribute(this.surfaces, 2));
    geometry.setIndex(this.corners);
    return new Mesh(geometry, material);
  }
}

const shade = new Color();

/** To the left of a line at its point *i*, of length 1. */
export function acrossOf(line: Line, i: number): [number, number] {
  const last = line.length / 3 - 1;
  const [a, b] = [3 * Math.max(i - 1, 0), 3 * Math.min(i + 1, last)];
  const [dx, dy] = [line[b]! - line[a]!, line[b + 1]! - line[a + 1]!];
  const size = Math.hypot(dx, dy) || 1;
  return [-dy / size, dx / size];
}

/** *line* with points at most *step* m apart. */
export function refined(line: Line, step: number): Line {
  const found: Line = line.slice(0, 3);
  for (let i = 3; i < line.length; i += 3) {
    const parts = Math.max(1, Math.ceil(Math.hypot(line[i]! - line[i - 3]!, line[i + 1]! - line[i - 2]!) / step));
    for (let k = 1; k <= parts; k++)
      for (let axis = 0; axis < 3; axis++)
        found.push(line[i - 3 + axis]! + (k / parts) * (line[i + axis]! - line[i - 3 + axis]!));
  }
  return found;
}

/** Calls *use* every *step* m along *line* from *start* on, with the place, the direction to the left, and the number. */
export function every(
  line: Line,
  step: number,
  start: number,
  use: (x: number, y: number, z: number, left: [number, number], number: number) => void,
): void {
  let [next, way, number] = [start, 0, 0];
  for (let i = 0; i + 5 < line.length; i += 3) {
    const [dx, dy, dz] = [line[i + 3]! - line[i]!, line[i + 4]! - line[i + 1]!, line[i + 5]! - line[i + 2]!];
    const length = Math.hypot(dx, dy);
    if (length === 0) continue;
    for (; next <= way + length; next += step) {
      const share = (next - way) / length;
      use(
        line[i]! + share * dx,
        line[i + 1]! + share * dy,
        line[i + 2]! + share * dz,
        [-dy / length, dx / length],
        number++,
      );
    }
    way += length;
  }
}
