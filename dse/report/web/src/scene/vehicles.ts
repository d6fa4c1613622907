// Road users: simple bodies of their own length, width and height, so that what a sensor meets is what is seen.
// A body is one mesh; the wheels, lamps and shades of all of them are drawn at once.
import {
  BoxGeometry,
  type BufferGeometry,
  CapsuleGeometry,
  Color,
  CylinderGeometry,
  Euler,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  Quaternion,
  type Scene,
  Vector3,
} from "three";
import { box, joined, LIT, painted } from "./light";

const GLASS = 0x2a323c;
const TYRE = 0x1c1e22;
const COLOURS = [0xd25040, 0xe6e6e0, 0x8e99a4, 0x56906c, 0xdcb44c, 0x6779cc, 0x9b648c, 0x4a5058];
const LIT_LAMP = new Color(0xff2a1c);
const DARK_LAMP = new Color(0x7a1a16);
const TAIL_LAMP = new Color(0xc01c14);
const HEAD_LAMP = new Color(0xfff6dc);

interface Wheel {
  x: number;
  y: number;
  radius: number;
  width: number;
  isSteered: boolean;
}

export interface Vehicle {
  /** In the axes of the road user, around its middle. */
  body: Mesh;
  wheels: Wheel[];
  /** At the back, and in front. */
  lamps: Vector3[];
  heads: Vector3[];
  shade: [number, number];
  /** Wheels turned about their axles (rad), and the front ones to the left. */
  spun: number;
  steered: number;
  brakes: boolean;
}

export function buildHost(length: number, width: number, forward: number): Vehicle {
  const host = car(0x3a72e8, length, width, 1.5);
  // Bodies are built around their middles, the car is told where its centre of gravity is.
  host.body.geometry.translate(forward, 0, 0);
  for (const part of [...host.wheels, ...host.lamps, ...host.heads]) part.x += forward;
  return host;
}

export function buildOther(kind: string, id: number, length: number, width: number, height: number): Vehicle {
  const colour = COLOURS[Math.abs(id) % COLOURS.length]!;
  if (kind === "truck") return truck(colour, length, width, height);
  if (kind === "pedestrian") return vehicle(person(colour, height, 0), [], [], [0.6, 0.6]);
  if (kind === "bicycle" || kind === "motorcycle") return rider(colour, length, height);
  if (kind === "obstacle")
    return vehicle([box([length, width, height], 0xe08c3c, [0, 0, height / 2])], [], [], [length, width]);
  return car(colour, length, width, height);
}

function vehicle(parts: BufferGeometry[], wheels: Wheel[], lamps: Vector3[], shade: [number, number]): Vehicle {
  const heads = lamps.map(({ x, y, z }) => new Vector3(-x, y, z));
  return { body: new Mesh(joined(parts), LIT), wheels, lamps, heads, shade, spun: 0, steered: 0, brakes: false };
}

function car(colour: number, length: number, width: number, height: number): Vehicle {
  const radius = Math.min(0.33, height / 4);
  const parts = [
    box([length, width, height * 0.4], colour, [0, 0, radius + height * 0.18], 0.06 * length * 0.4),
    box([length * 0.6, width * 0.88, height * 0.34], GLASS, [-length * 0.05, 0, height - height * 0.19], length * 0.1),
    box([length * 0.4, width * 0.86, 0.05], colour, [-length * 0.05, 0, height - 0.02]),
    box([0.05, width * 0.7, 0.13], 0xf4f1dc, [length / 2 - 0.02, 0, height * 0.42]),
    box([0.04, 0.5, 0.12], 0xe8e8e8, [-length / 2, 0, height * 0.33]),
  ];
  return vehicle(parts, fourWheels(length * 0.3, width, radius, 0.24), lampsAt(length, width, height * 0.46), [
    length,
    width,
  ]);
}

function truck(colour: number, length: number, width: number, height: number): Vehicle {
  const cab = Math.min(2.4, length * 0.3);
  const parts = [
    box([length - cab - 0.3, width, height * 0.78], 0xe4e4e0, [-(cab + 0.3) / 2, 0, height * 0.61]),
    box([cab, width, height * 0.7], colour, [(length - cab) / 2, 0, height * 0.5]),
    box([0.05, width * 0.9, height * 0.24], GLASS, [length / 2, 0, height * 0.64]),
    box([length * 0.94, width * 0.5, 0.3], 0x3a3d42, [0, 0, 0.75]),
  ];
  return vehicle(parts, fourWheels(length * 0.36, width, 0.5, 0.3), lampsAt(length, width, height * 0.3), [
    length,
    width,
  ]);
}

function rider(colour: number, length: number, height: number): Vehicle {
  const parts = [box([length * 0.6, 0.1, 0.12], colour, [0, 0, 0.6]), ...person(colour, height * 0.8, height * 0.2)];
  const wheels = [1, -1].map((end) => ({
    x: end * length * 0.33,
    y: 0,
    radius: 0.32,
    width: 0.08,
    isSteered: end > 0,
  }));
  return vehicle(parts, wheels, [], [length, 0.5]);
}

function person(colour: number, height: number, above: number): BufferGeometry[] {
  const body = new CapsuleGeometry(0.2, height * 0.55, 4, 8).rotateX(Math.PI / 2);
  const head = new CapsuleGeometry(0.12, 0.04, 4, 8).rotateX(Math.PI / 2);
  return [painted(body, colour, 0, 0, above + height * 0.42), painted(head, 0xd9a98a, 0, 0, above + height - 0.14)];
}

function fourWheels(axle: number, width: number, radius: number, broad: number): Wheel[] {
  return [1, -1].flatMap((end) =>
    [1, -1].map((side) => ({ x: end * axle, y: side * (width / 2 - 0.13), radius, width: broad, isSteered: end > 0 })),
  );
}

function lampsAt(length: number, width: number, height: number): Vector3[] {
  return [1, -1].map((side) => new Vector3(-length / 2 - 0.01, side * (width / 2 - 0.25), height));
}

/** What all road users have alike, as one mesh each: filled anew for every picture. */
export class Fleet {
  private readonly wheels: InstancedMesh;
  private readonly lamps: InstancedMesh;
  private readonly shades: InstancedMesh;
  private isDark = false;

  constructor(scene: Scene, most: number) {
    const tyre = painted(new CylinderGeometry(1, 1, 1, 14), TYRE);
    const spoke = painted(new BoxGeometry(1.3, 1.06, 0.3), 0xb0b6bd);
    const across = painted(new BoxGeometry(0.3, 1.06, 1.3), 0xb0b6bd);
    this.wheels = new InstancedMesh(joined([tyre, spoke, across]), LIT, 4 * most);
    this.lamps = new InstancedMesh(new BoxGeometry(0.06, 0.34, 0.15), new MeshBasicMaterial(), 4 * most);
    // A dark patch below costs nothing; shadows that are computed halve the frames without a graphics card.
    const dark = new MeshBasicMaterial({ color: 0x000000, transparent: true, opacity: 0.35, depthWrite: false });
    this.shades = new InstancedMesh(new BoxGeometry(1, 1, 0.01), dark, most);
    for (const mesh of [this.wheels, this.lamps, this.shades]) {
      mesh.frustumCulled = false;
      scene.add(mesh);
    }
    this.lamps.setColorAt(0, DARK_LAMP);
    this.clear(false);
  }

  /** Whether it *isDark* decides on the lamps of those who come. */
  clear(isDark: boolean): void {
    this.isDark = isDark;
    for (const mesh of [this.wheels, this.lamps, this.shades]) mesh.count = 0;
  }

  add({ body, wheels, lamps, heads, shade, spun, steered, brakes }: Vehicle): void {
    body.updateMatrix();
    for (const { x, y, radius, width, isSteered } of wheels) {
      turn.setFromEuler(angles.set(0, spun, isSteered ? steered : 0, "ZYX"));
      this.put(this.wheels, body, place.set(x, y, radius), size.set(radius, width, radius));
    }
    turn.identity();
    this.light(body, lamps, brakes ? LIT_LAMP : this.isDark ? TAIL_LAMP : DARK_LAMP);
    if (this.isDark) this.light(body, heads, HEAD_LAMP);
    this.put(this.shades, body, place.set(0, 0, 0.07), size.set(1.04 * shade[0], 1.1 * shade[1], 1));
  }

  finish(): void {
    for (const mesh of [this.wheels, this.lamps, this.shades]) mesh.instanceMatrix.needsUpdate = true;
    this.lamps.instanceColor!.needsUpdate = true;
  }

  private light(body: Mesh, lamps: Vector3[], colour: Color): void {
    for (const lamp of lamps) {
      this.lamps.setColorAt(this.lamps.count, colour);
      this.put(this.lamps, body, lamp, size.set(1, 1, 1));
    }
  }

  private put(mesh: InstancedMesh, body: Mesh, at: Vector3, scale: Vector3): void {
    mesh.setMatrixAt(mesh.count++, matrix.compose(at, turn, scale).premultiply(body.matrix));
  }
}

const angles = new Euler();
const turn = new Quaternion();
const place = new Vector3();
const size = new Vector3();
const matrix = new Matrix4();
