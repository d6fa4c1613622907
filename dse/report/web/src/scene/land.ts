// The land: at the height of the road beside it, with fields and hills farther away.
import { BufferGeometry, Color, Float32BufferAttribute, Group, Mesh, RingGeometry } from "three";
import type { RoadKind } from "./data";
import { LIT, painted } from "./light";
import { hash, noise } from "./random";
import type { RoadMap } from "./roadmap";

const REACH = 420; // m beside roads
const MOST = 30_000; // points
const FINEST = 24; // m between points
const FLAT = 14; // m beside the road without relief
const BELOW = 0.35; // m under the road where it meets the land
const CHUNK = 32;
const SEEN = 1100; // m up to which it is drawn

const FIELDS = [0x8aa653, 0xc2ac63, 0x6f9448, 0x9db463, 0xa98f5e, 0x7d9f4f, 0xd0bd7a, 0x5f8a45];
const GRASS: Record<RoadKind, number> = { motorway: 0x7f9a55, rural: 0x86a158, town: 0x8c9c72 };

export interface Land {
  group: Group;
  /** m; NaN where there is none. */
  height(x: number, y: number): number;
  /** From *eye* no farther than *reach* m. */
  show(x: number, y: number, z: number, above: boolean): void;
}

export function buildLand(roads: RoadMap, kind: RoadKind): Land {
  const group = new Group();
  const grid = gridAround(roads);
  heights(grid, roads, kind);
  const chunks: Mesh[] = [];
  for (let i = 0; i + 1 < grid.columns; i += CHUNK)
    for (let j = 0; j + 1 < grid.rows; j += CHUNK) {
      const mesh = chunk(grid, i, j, kind);
      if (mesh) chunks.push(mesh);
    }
  if (chunks.length) group.add(...chunks);
  const rings = [600, 1400, 3000].map((outer, k) =>
    painted(new RingGeometry([0, 600, 1400][k], outer, 32, 1), GRASS[kind]),
  );
  const plain = new Group();
  for (const ring of rings) {
    const mesh = new Mesh(ring, LIT);
    mesh.renderOrder = 1;
    plain.add(mesh);
  }
  const ridge = hills(kind);
  group.add(plain, ridge);
  return {
    group,
    height: (x, y) => heightAt(grid, x, y),
    show: (x, y, z, above) => {
      for (const mesh of chunks) {
        const sphere = mesh.geometry.boundingSphere!;
        mesh.visible = above || Math.hypot(sphere.center.x - x, sphere.center.y - y) - sphere.radius < SEEN;
      }
      plain.position.set(x, y, grid.lowest - 2.5);
      ridge.visible = !above;
      ridge.position.set(x, y, Math.min(grid.lowest, z - 6) - 6);
    },
  };
}

interface Grid {
  left: number;
  below: number;
  step: number;
  columns: number;
  rows: number;
  z: Float32Array;
  gap: Float32Array;
  lowest: number;
}

function gridAround(roads: RoadMap): Grid {
  let [left, right, below, above] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const { x, y } of roads.samples) {
    [left, right] = [Math.min(left, x), Math.max(right, x)];
    [below, above] = [Math.min(below, y), Math.max(above, y)];
  }
  if (!Number.isFinite(left)) [left, right, below, above] = [0, 1, 0, 1];
  const [wide, tall] = [right - left + 2 * REACH, above - below + 2 * REACH];
  const step = Math.max(FINEST, Math.sqrt((wide * tall) / MOST));
  const [columns, rows] = [Math.ceil(wide / step) + 1, Math.ceil(tall / step) + 1];
  const size = columns * rows;
  return {
    left: left - REACH,
    below: below - REACH,
    step,
    columns,
    rows,
    z: new Float32Array(size),
    gap: new Float32Array(size).fill(1e6),
    lowest: 0,
  };
}

/** From roads outwards: the lowest road nearby, then what the neighbours have, then hills on top. */
function heights(grid: Grid, roads: RoadMap, kind: RoadKind): void {
  const { columns, rows, step, z, gap } = grid;
  const reach = Math.ceil((FLAT + 2 * step) / step);
  const low = new Float32Array(z.length).fill(Infinity);
  for (const sample of roads.samples) {
    const [i, j] = [Math.round((sample.x - grid.left) / step), Math.round((sample.y - grid.below) / step)];
    for (let a = Math.max(i - reach, 0); a <= Math.min(i + reach, columns - 1); a++)
      for (let b = Math.max(j - reach, 0); b <= Math.min(j + reach, rows - 1); b++) {
        const at = b * columns + a;
        const far = Math.hypot(grid.left + a * step - sample.x, grid.below + b * step - sample.y) - sample.half;
        if (far < gap[at]!) {
          gap[at] = far;
          z[at] = sample.z;
        }
        if (far < FLAT + 1.5 * step) low[at] = Math.min(low[at]!, sample.z);
      }
  }
  const pass = (at: number, other: number, way: number): void => {
    if (gap[other]! + way < gap[at]!) {
      gap[at] = gap[other]! + way;
      z[at] = z[other]!;
    }
  };
  const slant = Math.SQRT2 * step;
  for (const forward of [true, false]) {
    for (let n = 0; n < z.length; n++) {
      const at = forward ? n : z.length - 1 - n;
      const [i, j] = [at % columns, Math.floor(at / columns)];
      const back = forward ? -1 : 1;
      if (i + back >= 0 && i + back < columns) pass(at, at + back, step);
      if (j + back < 0 || j + back >= rows) continue;
      pass(at, at + back * columns, step);
      for (const side of [-1, 1]) if (i + side >= 0 && i + side < columns) pass(at, at + back * columns + side, slant);
    }
  }
  grid.lowest = Infinity;
  const tall = kind === "town" ? 3 : 13;
  for (let at = 0; at < z.length; at++) {
    const [x, y] = [grid.left + (at % columns) * step, grid.below + Math.floor(at / columns) * step];
    const far = Math.max(0, Math.min(1, (gap[at]! - FLAT - 1.5 * step) / 140));
    const hill = 1.4 * (noise(x / 210, y / 210) - 0.42) + 0.5 * (noise(x / 70 + 9, y / 70) - 0.5);
    const base = Number.isFinite(low[at]!) ? low[at]! - BELOW : z[at]! - BELOW;
    z[at] = base + far * far * (3 - 2 * far) * hill * tall;
    if (gap[at]! < REACH) grid.lowest = Math.min(grid.lowest, z[at]!);
  }
  if (!Number.isFinite(grid.lowest)) grid.lowest = 0;
}

function heightAt(grid: Grid, x: number, y: number): number {
  const [u, v] = [(x - grid.left) / grid.step, (y - grid.below) / grid.step];
  const [i, j] = [Math.floor(u), Math.floor(v)];
  if (i < 0 || j < 0 || i + 1 >= grid.columns || j + 1 >= grid.rows) return NaN;
  const at = j * grid.columns + i;
  const [a, b] = [u - i, v - j];
  const z = grid.z;
  const near = z[at]! + a * (z[at + 1]! - z[at]!);
  const far = z[at + grid.columns]! + a * (z[at + grid.columns + 1]! - z[at + grid.columns]!);
  return near + b * (far - near);
}

function chunk(grid: Grid, i0: number, j0: number, kind: RoadKind): Mesh | null {
  const { columns, rows, step, z, gap } = grid;
  const [i1, j1] = [Math.min(i0 + CHUNK, columns - 1), Math.min(j0 + CHUNK, rows - 1)];
  let nearest = Infinity;
  for (let j = j0; j <= j1; j++) for (let i = i0; i <= i1; i++) nearest = Math.min(nearest, gap[j * columns + i]!);
  if (nearest > REACH) return null;
  const [points, colours, surfaces, corners] = [[], [], [], []] as number[][] as [
    number[],
    number[],
    number[],
    number[],
  ];
  const wide = i1 - i0 + 1;
  const colour = new Color();
  for (let j = j0; j <= j1; j++) {
    for (let i = i0; i <= i1; i++) {
      const at = j * columns + i;
      const [x, y] = [grid.left + i * step, grid.below + j * step];
      points.push(x, y, z[at]!);
      colour.set(gap[at]! < 26 || kind === "town" ? GRASS[kind] : field(x, y));
      const tone = 0.9 + 0.2 * noise(x / 31, y / 31);
      colours.push(colour.r * tone, colour.g * tone, colour.b * tone);
      surfaces.push(0, 0);
    }
  }
  for (let j = 0; j < j1 - j0; j++)
    for (let i = 0; i < i1 - i0; i++) {
      const a = j * wide + i;
      corners.push(a, a + 1, a + wide, a + 1, a + wide + 1, a + wide);
    }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colours, 3));
  geometry.setAttribute("surface", new Float32BufferAttribute(surfaces, 2));
  geometry.setIndex(corners);
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
  const mesh = new Mesh(geometry, LIT);
  mesh.renderOrder = 1;
  return mesh;
}

/** Fields lie side by side, turned a little against the map. */
function field(x: number, y: number): number {
  const [u, v] = [(0.9 * x + 0.43 * y) / 130, (0.9 * y - 0.43 * x) / 190];
  const column = Math.floor(u);
  return FIELDS[Math.floor(hash(column, Math.floor(v + 0.37 * column)) * FIELDS.length)]!;
}

/** A ridge around the eye, where the land ends. */
function hills(kind: RoadKind): Mesh {
  const [points, colours, surfaces, normals, corners] = [[], [], [], [], []] as unknown as [
    number[],
    number[],
    number[],
    number[],
    number[],
  ];
  const around = 96;
  const [low, high] = [new Color(0x7c9470), new Color(kind === "town" ? 0x7f9488 : 0x6d8a72)];
  for (let i = 0; i <= around; i++) {
    const angle = (2 * Math.PI * (i % around)) / around;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    const tall = 12 + 60 * noise(4 * c + 20, 4 * s) + 26 * noise(13 * c, 13 * s + 7);
    for (const [radius, z, tint] of [
      [1300, -10, low],
      [1500, 0.55 * tall, low],
      [1750, tall, high],
    ] as const) {
      points.push(radius * c, radius * s, z);
      colours.push(tint.r, tint.g, tint.b);
      surfaces.push(0, 0);
      normals.push(-0.5 * c, -0.5 * s, 0.8);
    }
    if (i < around)
      for (const k of [0, 1]) {
        const a = 3 * i + k;
        corners.push(a, a + 3, a + 1, a + 1, a + 3, a + 4);
      }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setAttribute("normal", new Float32BufferAttribute(normals, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colours, 3));
  geometry.setAttribute("surface", new Float32BufferAttribute(surfaces, 2));
  geometry.setIndex(corners);
  const mesh = new Mesh(geometry, LIT);
  mesh.frustumCulled = false;
  mesh.renderOrder = 1;
  return mesh;
}
