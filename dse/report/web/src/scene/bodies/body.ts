// What a body is: its mesh in three levels of detail, where its wheels and lamps are, and how its rider moves.
import type { BufferGeometry } from "three";

export interface Wheel {
  x: number;
  y: number;
  radius: number;
  width: number;
  isSteered: boolean;
}

export type LampKind = "brake" | "head" | "left" | "right";

export interface Lamp {
  kind: LampKind;
  place: [number, number, number];
  /** Across and up, in m. */
  size: [number, number];
}

/** An arm or a leg that swings about `place`, `length` m down; `phase` in turns. */
export interface Limb {
  place: [number, number, number];
  length: number;
  thick: number;
  phase: number;
  swing: number;
  colour: number;
}

/** In the axes of the road user: x ahead from its middle, y to the left, z up from the ground. */
export interface Body {
  /** Near, middle, far; each builds its mesh when it is asked for. */
  levels: (() => BufferGeometry)[];
  wheels: Wheel[];
  lamps: Lamp[];
  limbs: Limb[];
  shade: [number, number];
}

export const GLASS = 0x141b23;
export const BLACK = 0x17191c;
export const TRIM = 0x2b2f34;
export const CHROME = 0xb9c0c7;
export const WHITE = 0xffffff;

/** Wheels at both sides of axles at *xs*; those before `steered` m turn. */
export function axles(xs: number[], width: number, radius: number, broad: number, steered = 0): Wheel[] {
  return xs.flatMap((x) =>
    [1, -1].map((side) => ({
      x,
      y: side * (width / 2 - broad / 2 - 0.02),
      radius,
      width: broad,
      isSteered: x > steered,
    })),
  );
}

/** Brake lamps, headlamps and indicators at the corners of a body of *length* and *width*. */
export function corners(length: number, width: number, rear: number, front: number, inset = 0.2): Lamp[] {
  return [1, -1].flatMap((side): Lamp[] => {
    const y = side * (width / 2 - inset);
    const turn = side > 0 ? "left" : "right";
    const out = y + side * 0.09;
    return [
      { kind: "brake", place: [-length / 2 - 0.015, y, rear], size: [0.3, 0.13] },
      { kind: "head", place: [length / 2 - 0.03, y, front], size: [0.26, 0.12] },
      { kind: turn, place: [-length / 2 - 0.02, out, rear - 0.1], size: [0.13, 0.06] },
      { kind: turn, place: [length / 2 - 0.04, out, front - 0.09], size: [0.12, 0.05] },
    ];
  });
}
