// Pedestrians, whose arms and legs swing with their way, and riders of bicycles and motorcycles.
import { type BufferGeometry, CapsuleGeometry, CylinderGeometry, SphereGeometry, TorusGeometry } from "three";
import { box, joined, painted, type Surface } from "../light";
import { BLACK, type Body, type Limb, TRIM, WHITE } from "./body";

const CLOTH: Surface = [1, 0];
const METAL: Surface = [1, 0.3];
const MATT: Surface = [0, 0];
const SKINS = [0xe0b090, 0xc68a63, 0x8d5a3c, 0xf0c8a8];
const HAIR = [0x2a2018, 0x5a3c22, 0x8a7350, 0x1c1c20, 0xa0a0a0];
const LEGS = [0x28303c, 0x3c3a36, 0x4c5a70, 0x202226];

export function buildPedestrian(id: number, height: number): Body {
  const h = height;
  const skin = SKINS[id % SKINS.length]!;
  const leg = LEGS[(id >> 1) % LEGS.length]!;
  const torso = (sides: number): BufferGeometry[] => [
    painted(
      new CapsuleGeometry(0.095 * h, 0.2 * h, 3, sides).rotateX(Math.PI / 2).scale(0.75, 1.15, 1),
      WHITE,
      0,
      0,
      0.665 * h,
      CLOTH,
    ),
    painted(
      new SphereGeometry(0.062 * h, sides, sides - 2).scale(1, 0.85, 1.2).rotateX(Math.PI / 2),
      skin,
      0,
      0,
      0.925 * h,
    ),
    painted(
      new SphereGeometry(0.066 * h, sides, 4, 0, 2 * Math.PI, 0, 1.5).rotateX(Math.PI / 2).scale(1, 0.85, 1),
      HAIR[id % HAIR.length]!,
      -0.006 * h,
      0,
      0.94 * h,
    ),
  ];
  const limb = (
    y: number,
    z: number,
    length: number,
    phase: number,
    swing: number,
    colour: number,
    thick: number,
  ): Limb => ({
    place: [0, y * h, z * h],
    length: length * h,
    thick: thick * h,
    phase,
    swing,
    colour,
  });
  return {
    levels: [10, 8, 6].map((sides) => () => joined(torso(sides))),
    wheels: [],
    lamps: [],
    limbs: [
      limb(0.045, 0.53, 0.53, 0, 0.5, leg, 0.09),
      limb(-0.045, 0.53, 0.53, 0.5, 0.5, leg, 0.09),
      limb(0.125, 0.79, 0.34, 0.5, 0.4, 0, 0.055),
      limb(-0.125, 0.79, 0.34, 0, 0.4, 0, 0.055),
    ],
    shade: [0.4, 0.5],
  };
}

/** A rider on two wheels; *length* from tyre to tyre. */
export function buildRider(kind: "bicycle" | "motorcycle", id: number, length: number, height: number): Body {
  const isMotor = kind === "motorcycle";
  const radius = isMotor ? 0.31 : 0.34;
  const reach = Math.max(length / 2 - radius, 0.4);
  const seat = isMotor ? 0.8 : 0.92;
  const lean = isMotor ? 0.45 : 0.35;
  const above = Math.max(height - seat - 0.12, 0.5);
  const tube = (from: [number, number], to: [number, number], thick: number, colour = WHITE): BufferGeometry => {
    const [dx, dz] = [to[0] - from[0], to[1] - from[1]];
    const geometry = new CylinderGeometry(thick, thick, Math.hypot(dx, dz), 6).rotateX(Math.PI / 2);
    geometry.rotateY(Math.atan2(dx, dz));
    return painted(geometry, colour, (from[0] + to[0]) / 2, 0, (from[1] + to[1]) / 2, colour === WHITE ? METAL : MATT);
  };
  const machine = (): BufferGeometry[] => {
    const bars: BufferGeometry = box([0.05, isMotor ? 0.7 : 0.56, 0.04], BLACK, [reach - 0.3, 0, seat + 0.12]);
    const fork = tube([reach, radius], [reach - 0.28, seat + 0.08], isMotor ? 0.035 : 0.022, TRIM);
    if (isMotor) {
      return [
        bars,
        fork,
        painted(
          new CapsuleGeometry(0.17, 0.5, 3, 8).rotateZ(Math.PI / 2).scale(1, 0.75, 1),
          WHITE,
          0.08,
          0,
          0.72,
          METAL,
        ),
        box([0.5, 0.28, 0.34], TRIM, [0, 0, 0.42], 0.06),
        box([0.75, 0.26, 0.1], BLACK, [-0.35, 0, seat - 0.04], 0.05),
        tube([-reach, radius], [0, 0.4], 0.045, TRIM),
        painted(new CapsuleGeometry(0.14, 0.12, 3, 8), WHITE, reach - 0.2, 0, 0.86, METAL),
      ];
    }
    const crank: [number, number] = [-0.05, 0.3];
    return [
      bars,
      fork,
      tube([-reach, radius], crank, 0.018),
      tube([-reach, radius], [-0.2, seat - 0.1], 0.014),
      tube(crank, [-0.2, seat - 0.04], 0.022),
      tube(crank, [reach - 0.24, seat - 0.12], 0.024),
      tube([-0.18, seat - 0.16], [reach - 0.26, seat - 0.04], 0.02),
      box([0.26, 0.14, 0.05], BLACK, [-0.22, 0, seat - 0.02]),
      painted(new TorusGeometry(0.09, 0.012, 4, 12).rotateX(Math.PI / 2), TRIM, crank[0], 0.06, crank[1]),
    ];
  };
  const rider = (sides: number): BufferGeometry[] => {
    const x = -0.2;
    const [dx, dz] = [Math.sin(lean) * above, Math.cos(lean) * above];
    const body = new CapsuleGeometry(0.16, above * 0.45, 3, sides)
      .rotateX(Math.PI / 2)
      .scale(0.8, 1.1, 1)
      .rotateY(lean);
    return [
      painted(body, WHITE, x + dx * 0.45, 0, seat + dz * 0.42, CLOTH),
      painted(
        new SphereGeometry(isMotor ? 0.15 : 0.13, sides, sides),
        isMotor ? 0x23262b : 0xd8d8d4,
        x + dx + 0.06,
        0,
        seat + dz + 0.02,
        [0, isMotor ? 0.5 : 0.1],
      ),
      painted(new SphereGeometry(0.1, sides, sides), SKINS[id % SKINS.length]!, x + dx + 0.1, 0, seat + dz - 0.04),
    ];
  };
  const arm = (side: number): Limb => ({
    place: [-0.2 + Math.sin(lean) * above * 0.75, side * 0.2, seat + Math.cos(lean) * above * 0.7],
    length: 0.62,
    thick: 0.09,
    phase: 0,
    swing: -0.95,
    colour: 0,
  });
  const legs = (side: number): Limb => ({
    place: [-0.16, side * 0.12, seat],
    length: isMotor ? 0.5 : 0.64,
    thick: 0.13,
    phase: isMotor ? 0 : side > 0 ? 0 : 0.5,
    swing: isMotor ? -0.6 : 0.3,
    colour: LEGS[id % LEGS.length]!,
  });
  return {
    levels: [
      () => joined([...machine(), ...rider(10)]),
      () => joined([...machine(), ...rider(7)]),
      () => joined(rider(6)),
    ],
    wheels: [1, -1].map((end) => ({ x: end * reach, y: 0, radius, width: isMotor ? 0.14 : 0.04, isSteered: end > 0 })),
    lamps: [
      { kind: "brake", place: [-reach - 0.1, 0, seat - 0.12], size: [0.14, 0.09] },
      { kind: "head", place: [reach - 0.12, 0, seat + 0.02], size: [0.16, 0.14] },
    ],
    limbs: [arm(1), arm(-1), legs(1), legs(-1)],
    shade: [length, 0.5],
  };
}
