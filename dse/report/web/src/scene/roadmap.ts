// How far a place is from the roads, and how high they are there.
import type { Strip } from "./data";

const CELL = 24; // m
const STEP = 5;

interface Sample {
  x: number;
  y: number;
  z: number;
  half: number;
  strip: number;
}

export class RoadMap {
  readonly samples: Sample[] = [];
  private readonly cells = new Map<string, Sample[]>();

  constructor(strips: Strip[]) {
    strips.forEach(({ left, right }, strip) => {
      const count = Math.min(left.length, right.length) / 3;
      for (let i = 0; i + 1 < count; i++) {
        const [from, to] = [middle(left, right, i), middle(left, right, i + 1)];
        const parts = Math.max(1, Math.ceil(Math.hypot(to.x - from.x, to.y - from.y) / STEP));
        for (let k = 0; k < parts; k++) this.add(between(from, to, k / parts), strip);
      }
      if (count) this.add(middle(left, right, count - 1), strip);
    });
  }

  /** m from the edge of the nearest road (less than 0 on it) but for *strip*, up to about 20 m; its height. */
  nearest(x: number, y: number, strip = -1): { gap: number; z: number } {
    let found = { gap: Infinity, z: 0 };
    const [i, j] = [Math.floor(x / CELL), Math.floor(y / CELL)];
    for (let a = i - 1; a <= i + 1; a++) {
      for (let b = j - 1; b <= j + 1; b++) {
        for (const sample of this.cells.get(`${a} ${b}`) ?? []) {
          if (sample.strip === strip) continue;
          const gap = Math.hypot(x - sample.x, y - sample.y) - sample.half;
          if (gap < found.gap) found = { gap, z: sample.z };
        }
      }
    }
    return found;
  }

  private add(place: Omit<Sample, "strip">, strip: number): void {
    const sample = { ...place, strip };
    this.samples.push(sample);
    const name = `${Math.floor(place.x / CELL)} ${Math.floor(place.y / CELL)}`;
    const cell = this.cells.get(name);
    if (cell) cell.push(sample);
    else this.cells.set(name, [sample]);
  }
}

function middle(left: number[], right: number[], i: number): Omit<Sample, "strip"> {
  const [x, y, z] = [0, 1, 2].map((axis) => (left[3 * i + axis]! + right[3 * i + axis]!) / 2) as [
    number,
    number,
    number,
  ];
  const half = Math.hypot(left[3 * i]! - right[3 * i]!, left[3 * i + 1]! - right[3 * i + 1]!) / 2;
  return { x, y, z: Math.min(z, left[3 * i + 2]!, right[3 * i + 2]!), half };
}

function between(from: Omit<Sample, "strip">, to: Omit<Sample, "strip">, share: number): Omit<Sample, "strip"> {
  const part = (name: "x" | "y" | "z" | "half"): number => from[name] + share * (to[name] - from[name]);
  return { x: part("x"), y: part("y"), z: part("z"), half: part("half") };
}
