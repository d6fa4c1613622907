// Lorry with a trailer, rigid lorry and bus.
import type { BufferGeometry } from "three";
import { box, joined, type Surface } from "../light";
import { axles, BLACK, type Body, CHROME, corners, GLASS, TRIM, WHITE } from "./body";
import { type HalfRing, loft, type Station } from "./loft";

const PAINT: Surface = [1, 0.25];
const PANE: Surface = [0, 0.7];
const MATT: Surface = [0, 0];
const PLATE: Surface = [0, 0.12];
const RADIUS = 0.5;

/** Where a lorry is as long as a bus and as low, a bus is drawn: the data have one class for both. */
export function isBus(length: number, height: number): boolean {
  return length > 9.5 && length < 13.5 && height < 3.3;
}

export function buildLorry(length: number, width: number, height: number): Body {
  const isJointed = length > 12.5;
  const cab = Math.min(isJointed ? 2.3 : 2.1, 0.32 * length);
  const [back, front] = [-length / 2, length / 2];
  const load = length - cab - 0.55;
  const middle = back + load / 2;
  const steered = front - 1.35;
  const rear = isJointed ? [front - 5.1, back + 1.6, back + 2.9, back + 4.2] : [back + Math.min(2.2, 0.24 * length)];
  const body = (fine: boolean): BufferGeometry => {
    const parts = [
      block(middle, load, width, 1.05, height, 0xe9e9e6, PLATE),
      cabin(front - cab / 2, cab, width, Math.min(height - 0.15, 3.5)),
      box([length - 1.2, 0.9, 0.28], TRIM, [-0.3, 0, 0.86]),
      box([0.1, width * 0.92, 0.14], TRIM, [back + 0.06, 0, 0.55]),
    ];
    if (fine) {
      const tyres = rear.length > 1 ? back + 5.2 : back + 3.2;
      for (const side of [1, -1]) {
        parts.push(
          box([Math.max(front - cab - 1.2 - tyres, 1), 0.05, 0.5], 0xb9bdc0, [
            (front - cab - 1.2 + tyres) / 2,
            side * (width / 2 - 0.06),
            0.72,
          ]),
        );
        parts.push(box([0.2, 0.12, 0.55], BLACK, [front - 0.25, side * (width / 2 + 0.12), 2.2]));
        parts.push(box([0.06, 0.4, 0.2], 0x8c1512, [back - 0.005, side * (width / 2 - 0.3), 0.86], 0, PANE));
      }
      parts.push(box([0.04, 0.06, height - 1.3], 0xa8adb2, [back - 0.01, 0, (height + 1.2) / 2]));
      parts.push(box([0.04, 0.52, 0.12], 0xf2f2f0, [back - 0.02, 0, 0.62]));
    }
    return joined(parts);
  };
  const lamps = corners(length, width, 0.86, 0.8, 0.3);
  return {
    levels: [() => body(true), () => body(true), () => body(false)],
    wheels: axles([steered, ...rear], width, RADIUS, 0.32, steered - 0.1),
    lamps,
    limbs: [],
    shade: [length, width],
  };
}

export function buildBus(length: number, width: number, height: number): Body {
  const [w, half] = [width / 2, length / 2];
  const ring = (k: number, low: number): HalfRing => [
    [0, low],
    [w * 0.9 * k, low],
    [w * k, low + 0.1],
    [w * k, 1.15],
    [w * k * 0.995, 1.2],
    [w * k * 0.97, height - 0.5],
    [w * k * 0.955, height - 0.42],
    [w * k * 0.86, height - 0.02],
    [0, height],
  ];
  const posts = Math.max(Math.round(length / 1.6), 3);
  const body = (fine: boolean): BufferGeometry => {
    const xs = [-half, -half + 0.12, half - 0.2, half];
    if (fine) {
      for (let i = 1; i < posts; i++) {
        const x = -half + (i * length) / posts;
        xs.push(x - 0.05, x + 0.05);
      }
    }
    xs.sort((a, b) => a - b);
    const stations: Station[] = xs.map((x) => ({ x, half: ring(Math.abs(x) > half - 0.05 ? 0.96 : 1, 0.32) }));
    const parts = [
      loft(stations, (at, strip) => {
        const isPost = fine && at > 0 && at < xs.length - 2 && xs[at + 1]! - xs[at]! < 0.2;
        if (strip < 0) return [WHITE, PAINT];
        if (strip < 1) return [BLACK, MATT];
        if (strip === 4) return isPost ? [BLACK, MATT] : [GLASS, PANE];
        return [WHITE, PAINT];
      }),
      box([0.06, width * 0.86, 1.5], GLASS, [half - 0.005, 0, 1.95], 0, PANE),
      box([0.06, width * 0.8, 0.9], GLASS, [-half + 0.005, 0, 2.2], 0, PANE),
      box([0.06, width * 0.6, 0.28], 0x1a1a12, [half + 0.01, 0, height - 0.3]),
    ];
    for (const side of [1, -1])
      parts.push(box([0.08, 0.34, 0.5], 0x8c1512, [-half + 0.005, side * (w - 0.22), 1.0], 0, PANE));
    if (fine)
      for (const side of [1, -1]) parts.push(box([0.12, 0.1, 0.5], BLACK, [half + 0.12, side * (w + 0.1), 2.3]));
    return joined(parts);
  };
  const front = half - 2.6;
  return {
    levels: [() => body(true), () => body(true), () => body(false)],
    wheels: axles([front, -half + 3.2], width + 0.04, RADIUS, 0.3),
    lamps: corners(length, width, 1.0, 0.7, 0.3),
    limbs: [],
    shade: [length, width],
  };
}

/** A box with narrow bevels. */
function block(
  x: number,
  length: number,
  width: number,
  low: number,
  high: number,
  colour: number,
  surface: Surface,
): BufferGeometry {
  const w = width / 2;
  const half: HalfRing = [
    [0, low],
    [w - 0.03, low],
    [w, low + 0.04],
    [w, high - 0.08],
    [w - 0.08, high],
    [0, high],
  ];
  const ends = [x - length / 2, x + length / 2].map((each): Station => ({ x: each, half }));
  return loft(ends, () => [colour, surface], 0.3);
}

function cabin(x: number, length: number, width: number, top: number): BufferGeometry {
  const w = width / 2;
  const ring = (k: number, roof: number): HalfRing => [
    [0, 0.42],
    [w * k, 0.42],
    [w * k, 1.0],
    [w * k, 1.75],
    [w * k * 0.985, 2.55],
    [w * k * 0.95, roof - 0.15],
    [w * k * 0.8, roof],
    [0, roof + 0.02],
  ];
  const [back, front] = [x - length / 2, x + length / 2];
  const stations: Station[] = [
    { x: back, half: ring(0.97, top) },
    { x: back + 0.5, half: ring(0.98, top) },
    { x: front - 0.45, half: ring(0.98, top - 0.06) },
    { x: front - 0.1, half: ring(0.95, top - 0.3) },
    { x: front, half: ring(0.88, top - 0.62) },
  ];
  const shell = loft(stations, (at, strip) => {
    if (strip === 0) return [BLACK, MATT];
    if (strip === 1) return [TRIM, MATT];
    if (strip === 3 && at === 1) return [GLASS, PANE];
    return [WHITE, PAINT];
  });
  return joined([
    shell,
    box([0.05, width * 0.84, 0.82], GLASS, [front + 0.005, 0, 2.2], 0, PANE),
    box([0.05, width * 0.7, 0.5], BLACK, [front + 0.005, 0, 1.32]),
    box([0.06, width * 0.6, 0.05], CHROME, [front + 0.01, 0, 1.62], 0, PANE),
    ...[1, -1].map((side) => box([0.08, 0.34, 0.2], 0xdfe6ea, [front - 0.01, side * (w - 0.3), 0.8], 0, PANE)),
  ]);
}
