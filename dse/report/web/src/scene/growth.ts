// What stands in the land: shapes of trees, bushes, houses and lamps, each in one mesh that is drawn many times.
import { type BufferGeometry, ConeGeometry, CylinderGeometry, IcosahedronGeometry, PlaneGeometry } from "three";
import { mergeVertices } from "three/addons/utils/BufferGeometryUtils.js";
import { Faces } from "./bodies/loft";
import { box, joined, LAMPLIT, painted, type Surface } from "./light";
import { hash } from "./random";

const TINTED: Surface = [1, 0];
const BARK = 0x5b4936;

/** A crumpled ball around (x, y, z), so that no two sides of a crown are the same; darker below, as leaves shade leaves. */
function crown(
  radius: number,
  flat: number,
  seed: number,
  detail: number,
  colour = 0xffffff,
  [x, y, z]: [number, number, number] = [0, 0, 0],
): BufferGeometry {
  const ball = mergeVertices(new IcosahedronGeometry(radius, detail).deleteAttribute("uv").deleteAttribute("normal"));
  const points = ball.getAttribute("position");
  for (let i = 0; i < points.count; i++) {
    const [a, b, c] = [points.getX(i), points.getY(i), points.getZ(i)];
    const key = (value: number): number => Math.round(value * 50);
    const k = 0.8 + 0.4 * hash(key(a) + 7 * key(c), key(b), seed);
    points.setXYZ(i, a * k, b * k, c * k * flat);
  }
  ball.computeVertexNormals();
  const leaves = painted(ball, colour, x, y, z, TINTED);
  const [place, shade] = [leaves.getAttribute("position"), leaves.getAttribute("color")];
  for (let i = 0; i < place.count; i++) {
    const key = (value: number): number => Math.round(value * 300);
    const up = (place.getZ(i) - z) / (radius * flat);
    const tone = 0.92 + 0.16 * up + 0.18 * (hash(key(place.getX(i)), key(place.getY(i)), key(place.getZ(i))) - 0.5);
    shade.setXYZ(i, tone * shade.getX(i), tone * shade.getY(i), tone * shade.getZ(i));
  }
  return leaves;
}

/** Trees of height 1, leafy ones wide, others slim; *fine* ones are seen from near. */
export function treeShapes(fine: boolean): BufferGeometry[] {
  const trunk = (thick: number, high: number): BufferGeometry =>
    painted(new CylinderGeometry(0.6 * thick, thick, high, 5, 1, true).rotateX(Math.PI / 2), BARK, 0, 0, high / 2);
  const leafy = (seed: number): BufferGeometry =>
    joined([
      trunk(0.03, 0.42),
      crown(0.27, 0.95, seed, fine ? 2 : 0, 0xffffff, [0, 0, 0.66]),
      ...(fine ? boughs(seed) : []),
    ]);
  const boughs = (seed: number): BufferGeometry[] => [
    crown(0.19, 0.9, seed + 1, 1, 0xe4ead6, [0.15, 0.06, 0.54]),
    crown(0.18, 0.9, seed + 2, 1, 0xd8e0c8, [-0.12, -0.11, 0.57]),
    crown(0.17, 0.9, seed + 3, 1, 0xf2f4ea, [-0.05, 0.12, 0.8]),
  ];
  const fir = joined([
    trunk(0.025, 0.2),
    ...[0, 1, 2].map((i) =>
      painted(
        new ConeGeometry(0.2 - 0.045 * i, 0.42, fine ? 8 : 5, 1, true).rotateX(Math.PI / 2),
        0xb8c8b0,
        0,
        0,
        0.32 + 0.24 * i,
        TINTED,
      ),
    ),
  ]);
  return [leafy(1), leafy(5), fir];
}

/** A piece of hedge or a bush, 1 m high and 2 m long. */
export function bushShape(fine: boolean): BufferGeometry {
  return crown(0.75, 0.62, 3, fine ? 1 : 0)
    .scale(1.5, 0.7, 1)
    .translate(0, 0, 0.4);
}

/** A house 1 wide, 1 deep and 1 high to its eaves, with a façade to the front (-x): *floors* and *columns* of windows.
 *
 * The finest *level* is 0; at 2 the windows of a floor are one band.
 */
export function houseShape(
  floors: number,
  columns: number,
  isFlat: boolean,
  seed: number,
  level: number,
): BufferGeometry {
  const fine = level === 0;
  const wall = box([1, 1, 1], 0xffffff, [0, 0, 0.5], 0, TINTED);
  const parts = [wall, isFlat ? box([1.05, 1.02, 0.035], 0x8b877f, [0, 0, 1.015]) : roof()];
  const [high, wide] = [1 / floors, 1 / columns];
  if (level > 1) {
    for (let floor = 0; floor < floors; floor++)
      parts.push(pane([-0.502, 0, (floor + 0.54) * high], [0.86, 0.4 * high], 0x56616a, 0.3));
    return joined(parts);
  }
  parts.push(box([1.02, 1.005, 0.06], 0x8d8881, [0, 0, 0.03]));
  for (let floor = 0; floor < floors; floor++) {
    const isShop = floor === 0 && seed % 2 === 0 && isFlat;
    for (let column = 0; column < columns; column++) {
      const isDoor = floor === 0 && column === seed % columns;
      const y = -0.5 + (column + 0.5) * wide;
      const z = (floor + (isDoor ? 0.4 : 0.54)) * high;
      const size: [number, number] = [
        wide * (isShop ? 0.8 : isDoor ? 0.36 : 0.42),
        high * (isDoor ? 0.8 : isShop ? 0.66 : 0.52),
      ];
      const glass = isDoor ? 0x5a4030 : hash(column, floor, seed) > 0.85 ? 0x8a8678 : 0x2c3844;
      if (fine) parts.push(pane([-0.506, y, z], [size[0] * 1.25, size[1] * 1.16], 0xefece4, 0));
      const isLit = !isDoor && (isShop || hash(column, floor, seed + 9) > 0.6);
      parts.push(pane([-0.511, y, z], size, glass, isDoor ? 0 : 0.55, 0, isLit));
      if (fine && floor > 0 && !isFlat)
        parts.push(pane([-0.513, y, (floor + 0.26) * high], [wide * 0.6, 0.05 * high], 0xdad5ca, 0));
    }
    if (!floor) continue;
    for (const side of [1, -1])
      parts.push(pane([0.05, side * 0.509, (floor + 0.54) * high], [0.3, high * 0.42], 0x36424c, 0.4, side));
  }
  return joined(parts);
}

/** A window around *place*: in the façade, or with a *side* of 1 or -1 in a wall beside it; *isLit* by night. */
function pane(
  place: [number, number, number],
  [wide, high]: [number, number],
  colour: number,
  gloss: number,
  side = 0,
  isLit = false,
): BufferGeometry {
  const plane = side
    ? new PlaneGeometry(wide, high).rotateX((-side * Math.PI) / 2)
    : new PlaneGeometry(high, wide).rotateY(-Math.PI / 2);
  return painted(plane, colour, ...place, [isLit ? LAMPLIT : 0, gloss]);
}

function roof(): BufferGeometry {
  const faces = new Faces();
  const [tiles, gable, none] = [0x8a4636, 0xffffff, [0, 0] as Surface];
  const [a, b, c, d] = [
    [-0.56, -0.52, 0.98],
    [0.56, -0.52, 0.98],
    [0.56, 0.52, 0.98],
    [-0.56, 0.52, 0.98],
  ] as [number, number, number][];
  const [e, f] = [
    [0, -0.52, 1.36],
    [0, 0.52, 1.36],
  ] as [number, number, number][];
  faces.quad(a!, e!, f!, d!, tiles, none);
  faces.quad(b!, c!, f!, e!, tiles, none);
  faces.triangle(a!, b!, e!, gable, TINTED);
  faces.triangle(c!, d!, f!, gable, TINTED);
  faces.quad(a!, d!, c!, b!, 0x6a655c, none);
  return faces.geometry(0.2);
}

/** A street lamp of 1 m height whose arm points along -x. */
export function lampShape(): BufferGeometry {
  return joined([
    painted(new CylinderGeometry(0.007, 0.012, 1, 6, 1, true).rotateX(Math.PI / 2), 0x777d82, 0, 0, 0.5),
    box([0.24, 0.012, 0.012], 0x777d82, [-0.12, 0, 0.995]),
    box([0.11, 0.035, 0.016], 0xd9dde0, [-0.24, 0, 0.99]),
  ]);
}

/** A post at the edge of a country road, with its black band and reflector. */
export function postShape(): BufferGeometry {
  return joined([
    box([0.09, 0.11, 0.95], 0xf0f0ec, [0, 0, 0.475]),
    box([0.092, 0.112, 0.2], 0x17191c, [0, 0, 0.78]),
    box([0.096, 0.04, 0.13], 0xf6d9a0, [0, 0, 0.78]),
  ]);
}
