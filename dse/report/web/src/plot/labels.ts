// Names written into the plot: along each boundary, and in the middle of each region.
import type { Grid } from "../plane/fields";
import type { Palette } from "../theme";
import type { Ring } from "./contour";
import type { Frame } from "./frame";
import type { Pen } from "./pen";

interface Spot {
  x: number;
  y: number;
  radius: number;
}

/** Writes `text` along the straightest long stretch of the rings that is free; returns the places taken. */
export function labelBoundary(
  pen: Pen,
  frame: Frame,
  rings: Ring[],
  text: string,
  colour: string,
  colours: Palette,
  taken: Spot[],
  free: (x: number, y: number) => boolean,
): void {
  pen.font = `600 11.5px ${colours.font}`;
  const width = pen.measureText(text).width + 10;
  const best = { score: 0.5, x: 0, y: 0, angle: 0 };
  for (const line of rings.flatMap((ring) => runsInside(finely(ring), frame))) {
    for (let start = 0; start < line.length; start += Math.max(1, Math.floor(line.length / 60))) {
      const end = reach(line, start, width);
      if (end < 0) break;
      const [a, b] = [line[start]!, line[end]!];
      const chord = Math.hypot(b[0] - a[0], b[1] - a[1]);
      const middle = line[Math.floor((start + end) / 2)]!;
      const sag = Math.abs((b[0] - a[0]) * (a[1] - middle[1]) - (a[0] - middle[0]) * (b[1] - a[1])) / chord;
      const centred = 1 - Math.abs((start + end) / 2 / line.length - 0.5);
      const score = centred - sag / 12 - (chord < 0.9 * width ? 1 : 0);
      if (score <= best.score) continue;
      let angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
      if (Math.abs(angle) > Math.PI / 2) angle -= Math.sign(angle) * Math.PI;
      // The label sits beside the line, on the side that is free.
      for (const side of [-1, 1]) {
        const offset = side * (11 + sag);
        const x = (a[0] + b[0]) / 2 - Math.sin(angle) * offset;
        const y = (a[1] + b[1]) / 2 + Math.cos(angle) * offset;
        if (!fits(frame, x, y, width, angle) || !free(x, y) || collides(taken, x, y, width, angle)) continue;
        Object.assign(best, { score, x, y, angle });
        break;
      }
    }
  }
  if (best.score <= 0.5) return;
  pen.save();
  pen.translate(best.x, best.y);
  pen.rotate(best.angle);
  write(pen, text, colour, colours.plot);
  pen.restore();
  taken.push(...spotsOf(best.x, best.y, width, best.angle));
}

/** Writes lines of text at the innermost place of a region, if it is wide enough there. */
export function labelRegion(
  pen: Pen,
  frame: Frame,
  grid: Grid,
  inside: (node: number) => boolean,
  lines: string[],
  halo: string,
  colours: Palette,
  taken: Spot[],
): void {
  pen.font = `500 12px ${colours.font}`;
  const width = Math.max(...lines.map((line) => pen.measureText(line).width));
  const wide = grid.xs.length;
  const stepX = Math.abs(frame.x(grid.xs.at(-1)!) - frame.x(grid.xs[0]!)) / (wide - 1);
  const stepY = Math.abs(frame.y(grid.ys.at(-1)!) - frame.y(grid.ys[0]!)) / (grid.ys.length - 1);
  const depth = depths(grid, inside);
  const step = Math.sqrt(stepX * stepY);
  let best = -1;
  for (let node = 0; node < depth.length; node++) {
    if (depth[node]! * step < 16 || (best >= 0 && depth[node]! <= depth[best]!)) continue;
    const half = Math.round(width / 2 / stepX);
    const row = node - (node % wide);
    const [first, last] = [node - half, node + half];
    if (first < row || last >= row + wide || !inside(first) || !inside(last)) continue;
    const [x, y] = place(node);
    if (fits(frame, x, y, width + 12, 0) && !collides(taken, x, y, width, 0)) best = node;
  }
  if (best < 0) return;
  const [x, y] = place(best);
  lines.forEach((line, index) => {
    pen.save();
    pen.translate(x, y + (index - (lines.length - 1) / 2) * 15);
    write(pen, line, colours.muted, halo);
    pen.restore();
  });
  taken.push(...spotsOf(x, y, width, 0));

  function place(node: number): [number, number] {
    return [frame.x(grid.xs[node % wide]!), frame.y(grid.ys[Math.floor(node / wide)]!)];
  }
}

function write(pen: Pen, text: string, colour: string, halo: string): void {
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.lineJoin = "round";
  pen.strokeStyle = halo;
  pen.lineWidth = 5;
  pen.strokeText(text, 0, 0);
  pen.strokeText(text, 0, 0);
  pen.fillStyle = colour;
  pen.fillText(text, 0, 0);
}

// The stretches of a ring that are truly inside the plot, not on its rim.
function runsInside(ring: Ring, { left, right, top, bottom }: Frame): Ring[] {
  const stretches: Ring[] = [];
  let stretch: Ring = [];
  for (const point of ring) {
    if (point[0] > left + 2 && point[0] < right - 2 && point[1] > top + 2 && point[1] < bottom - 2) stretch.push(point);
    else if (stretch.length) {
      stretches.push(stretch);
      stretch = [];
    }
  }
  if (stretch.length) stretches.push(stretch);
  return stretches;
}

// Points no more than a few pixels apart, so that a label can start anywhere.
function finely(ring: Ring): Ring {
  const fine: Ring = [];
  ring.forEach((point, index) => {
    const next = ring[index + 1];
    const parts = next ? Math.min(200, Math.ceil(Math.hypot(next[0] - point[0], next[1] - point[1]) / 5)) || 1 : 1;
    for (let part = 0; part < parts; part++) {
      const share = part / parts;
      fine.push(
        next && share ? [point[0] + share * (next[0] - point[0]), point[1] + share * (next[1] - point[1])] : point,
      );
    }
  });
  return fine;
}

function reach(line: Ring, start: number, width: number): number {
  let length = 0;
  for (let i = start + 1; i < line.length; i++) {
    length += Math.hypot(line[i]![0] - line[i - 1]![0], line[i]![1] - line[i - 1]![1]);
    if (length >= width) return i;
  }
  return -1;
}

function spotsOf(x: number, y: number, width: number, angle: number): Spot[] {
  const count = Math.max(1, Math.round(width / 14));
  return Array.from({ length: count + 1 }, (_, i) => {
    const along = (i / count - 0.5) * width;
    return { x: x + Math.cos(angle) * along, y: y + Math.sin(angle) * along, radius: 10 };
  });
}

function collides(taken: Spot[], x: number, y: number, width: number, angle: number): boolean {
  return spotsOf(x, y, width, angle).some((spot) =>
    taken.some((other) => Math.hypot(other.x - spot.x, other.y - spot.y) < other.radius + spot.radius),
  );
}

function fits({ left, right, top, bottom }: Frame, x: number, y: number, width: number, angle: number): boolean {
  const half = { x: Math.abs(Math.cos(angle)) * (width / 2) + 8, y: Math.abs(Math.sin(angle)) * (width / 2) + 8 };
  return x - half.x > left && x + half.x < right && y - half.y > top && y + half.y < bottom;
}

// Steps to the nearest node outside the region, or to the rim (chamfer distance, Borgefors 1986).
function depths({ xs, ys }: Grid, inside: (node: number) => boolean): Float32Array {
  const [nx, ny] = [xs.length, ys.length];
  const depth = new Float32Array(nx * ny);
  const at = (i: number, j: number): number => (i < 0 || j < 0 || i >= nx || j >= ny ? 0 : depth[j * nx + i]!);
  for (let j = 0; j < ny; j++) {
    for (let i = 0; i < nx; i++) {
      if (!inside(j * nx + i)) continue;
      depth[j * nx + i] = 1 + Math.min(at(i - 1, j), at(i, j - 1), at(i - 1, j - 1) + 0.4, at(i + 1, j - 1) + 0.4);
    }
  }
  for (let j = ny - 1; j >= 0; j--) {
    for (let i = nx - 1; i >= 0; i--) {
      const back = 1 + Math.min(at(i + 1, j), at(i, j + 1), at(i + 1, j + 1) + 0.4, at(i - 1, j + 1) + 0.4);
      depth[j * nx + i] = Math.min(depth[j * nx + i]!, back);
    }
  }
  return depth;
}

export type { Spot };
