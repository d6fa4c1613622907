// Where what stands beside a road is put: by the kind of road, from its own course, so that it is the same each time.
import {
  type BufferGeometry,
  Color,
  Frustum,
  Group,
  InstancedBufferAttribute,
  InstancedMesh,
  Matrix4,
  type PerspectiveCamera,
  Quaternion,
  Sphere,
  Vector3,
} from "three";
import type { Document, StandingObject } from "./data";
import { bushShape, houseShape, lampShape, postShape, treeShapes } from "./growth";
import type { Land } from "./land";
import { BODY, box, indexed, LIT } from "./light";
import { hash, noise, sequence } from "./random";
import { every } from "./ribbons";
import { outerBorders } from "./road";
import type { RoadMap } from "./roadmap";

const LEAVES = [0x6f8f45, 0x5d8540, 0x7f9a4a, 0x55773a, 0x8a9c50];
const NEEDLES = [0x4f7048, 0x48684a, 0x587a50];
const WALLS = [0xe8dcc4, 0xd9c2a0, 0xcfd3d2, 0xe6d3b8, 0xb9a58c, 0xdfe3df, 0xc98f73, 0xe9e2d2, 0xa9b4b0];
const LAMP = 7; // m
const MOST = 9000;
const FINE = 100; // m

type Kind = "leafy" | "broad" | "fir" | "bush" | "house" | "block" | "office" | "lamp" | "post" | "box";

interface Planted {
  kind: Kind;
  x: number;
  y: number;
  z: number;
  turn: number;
  size: [number, number, number];
  colour: number;
}

export interface Lamp {
  head: Vector3;
  ground: number;
}

export interface Planting {
  group: Group;
  /** Heads of street lamps, and the ground below them. */
  lamps: Lamp[];
  /** Draws what *camera* sees within *reach* m. */
  show(camera: PerspectiveCamera, reach: number): void;
}

export function buildPlanting(document: Document, roads: RoadMap, land: Land): Planting {
  const planted = plant(document, roads, land);
  const group = new Group();
  const shapes = [0, 1, 2].map(shapesOf);
  const crowds = KINDS.flatMap((kind) => {
    const own = planted.filter((each) => each.kind === kind);
    return own.length
      ? [
          new Crowd(
            own,
            shapes.map((shape) => shape[kind]),
            group,
          ),
        ]
      : [];
  });
  const lamps = planted
    .filter(({ kind }) => kind === "lamp")
    .map(({ x, y, z, turn, size: [wide, , high] }) => {
      const arm = 0.24 * wide;
      return { head: new Vector3(x - arm * Math.cos(turn), y - arm * Math.sin(turn), z + 0.98 * high), ground: z };
    });
  return {
    group,
    lamps,
    show: (camera, reach) => {
      view.setFromProjectionMatrix(matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
      for (const crowd of crowds) crowd.show(camera.position, reach);
    },
  };
}

const KINDS: Kind[] = ["leafy", "broad", "fir", "bush", "house", "block", "office", "lamp", "post", "box"];

/** All of a kind: those in view are drawn, nearer ones finer and first, so that they hide what is behind them. */
class Crowd {
  private readonly meshes: InstancedMesh[];
  private readonly matrices: Float32Array;
  private readonly colours: Float32Array;
  /** Centre and radius of each. */
  private readonly spheres: Float32Array;
  private readonly isTall: boolean;

  constructor(planted: Planted[], shapes: BufferGeometry[], group: Group) {
    const { kind } = planted[0]!;
    this.isTall = kind === "house" || kind === "block" || kind === "office";
    this.matrices = new Float32Array(16 * planted.length);
    this.colours = new Float32Array(3 * planted.length);
    this.spheres = new Float32Array(4 * planted.length);
    const { center, radius } = boundsOf(shapes[0]!);
    planted.forEach((each, i) => {
      matrix.compose(place.set(each.x, each.y, each.z), turned.setFromAxisAngle(up, each.turn), size.set(...each.size));
      matrix.toArray(this.matrices, 16 * i);
      tint.set(each.colour).toArray(this.colours, 3 * i);
      place
        .copy(center)
        .applyMatrix4(matrix)
        .toArray(this.spheres, 4 * i);
      this.spheres[4 * i + 3] = radius * Math.max(...each.size);
    });
    const material = kind === "post" || kind === "lamp" ? LIT : BODY;
    this.meshes = shapes.map((shape, level) => {
      const mesh = new InstancedMesh(shape, material, planted.length);
      mesh.frustumCulled = false;
      mesh.renderOrder = level - 3;
      mesh.instanceColor = new InstancedBufferAttribute(new Float32Array(3 * planted.length), 3);
      group.add(mesh);
      return mesh;
    });
  }

  show(eye: Vector3, reach: number): void {
    const most = (this.isTall ? 1.3 : 1) * reach;
    const ends = [Math.min(FINE, 0.3 * reach), 0.45 * reach];
    for (const mesh of this.meshes) mesh.count = 0;
    const { spheres } = this;
    for (let i = 0, at = 0; at < spheres.length; i++, at += 4) {
      const far = Math.hypot(spheres[at]! - eye.x, spheres[at + 1]! - eye.y);
      if (far > most) continue;
      ball.center.fromArray(spheres, at);
      ball.radius = spheres[at + 3]!;
      if (!view.intersectsSphere(ball)) continue;
      const mesh = this.meshes[far < ends[0]! ? 0 : far < ends[1]! ? 1 : 2]!;
      mesh.instanceMatrix.array.set(this.matrices.subarray(16 * i, 16 * i + 16), 16 * mesh.count);
      mesh.instanceColor!.array.set(this.colours.subarray(3 * i, 3 * i + 3), 3 * mesh.count++);
    }
    for (const mesh of this.meshes) {
      mesh.visible = mesh.count > 0;
      sendFirst(mesh.instanceMatrix, mesh.count);
      sendFirst(mesh.instanceColor!, mesh.count);
    }
  }
}

function boundsOf(shape: BufferGeometry): Sphere {
  shape.computeBoundingSphere();
  return shape.boundingSphere!;
}

function sendFirst(attribute: InstancedBufferAttribute, count: number): void {
  attribute.clearUpdateRanges();
  if (!count) return;
  attribute.addUpdateRange(0, count * attribute.itemSize);
  attribute.needsUpdate = true;
}

type Shapes = Record<Kind, BufferGeometry>;

/** From the finest (0) to those that are seen from far away (2). */
function shapesOf(level: number): Shapes {
  const isFine = level === 0;
  const [leafy, broad, fir] = treeShapes(isFine) as [BufferGeometry, BufferGeometry, BufferGeometry];
  const shapes: Shapes = {
    leafy,
    broad,
    fir,
    bush: bushShape(isFine),
    house: houseShape(2, 3, false, 1, level),
    block: houseShape(4, 4, false, 3, level),
    office: houseShape(5, 6, true, 2, level),
    lamp: lampShape(),
    post: postShape(),
    box: box([1, 1, 1], 0xffffff, [0, 0, 0.5], 0, [1, 0]),
  };
  for (const kind of KINDS) shapes[kind] = indexed(shapes[kind]);
  return shapes;
}

/** Everything that is planted; from the objects of the road's file where it has such. */
export function plant(document: Document, roads: RoadMap, land: Pick<Land, "height">): Planted[] {
  const { kind, objects } = document;
  const found: Planted[] = objects.flatMap(fromObject);
  const has = (...kinds: Kind[]): boolean => found.some((each) => kinds.includes(each.kind));
  const [hasTrees, hasHouses, hasLamps] = [has("leafy", "fir", "broad"), has("house", "block", "office"), has("lamp")];
  const put: Put = (what, x, y, turn, size, colour, free) => {
    if (found.length >= MOST) return;
    if (roads.nearest(x, y).gap < free) return;
    const z = land.height(x, y);
    if (Number.isFinite(z)) found.push({ kind: what, x, y, z: z - 0.05, turn, size, colour });
  };
  const tree = (x: number, y: number, random: number, free: number, tall = 1): void => {
    const isFir = kind !== "town" && noise(x / 90 + 40, y / 90) > 0.55;
    const colours = isFir ? NEEDLES : LEAVES;
    const high = tall * (isFir ? 9 + 7 * random : 6.5 + 6 * random);
    put(
      isFir ? "fir" : random > 0.5 ? "leafy" : "broad",
      x,
      y,
      6.28 * random,
      [high, high, high],
      colours[Math.floor(random * colours.length)]!,
      free,
    );
  };
  outerBorders(document.strips).forEach(({ line, side, strip }) => {
    if (strip.kind === "curb") return;
    const random = sequence(Math.abs(Math.round(line[0]! * 7 + line[1]! * 13)) + (side > 0 ? 1 : 2));
    const at = (
      step: number,
      aside: number,
      use: (x: number, y: number, turn: number, r: number, z: number) => void,
    ): void =>
      every(line, step, step * (0.2 + 0.6 * random()), (x, y, z, [nx, ny]) => {
        const turn = Math.atan2(side * ny, side * nx);
        use(x + side * aside * nx, y + side * aside * ny, turn, random(), z);
      });
    if (kind === "town") {
      if (!hasHouses) houses(at, put);
      if (!hasTrees) at(19, 1.7, (x, y, _, r) => r > 0.25 && tree(x, y, r * 0.5, 0.6, 0.8));
      if (!hasLamps)
        at(34, 0.6, (x, y, turn, __, z) => {
          if (roads.nearest(x, y).gap > 0.2)
            found.push({ kind: "lamp", x, y, z: z + 0.1, turn, size: [LAMP, LAMP, LAMP], colour: 0xffffff });
        });
      return;
    }
    if (kind === "rural")
      at(50, 0.9, (x, y, turn, __, z) => {
        if (roads.nearest(x, y).gap > 0.4)
          found.push({ kind: "post", x, y, z: z - 0.05, turn, size: [1, 1, 1], colour: 0xffffff });
      });
    if (hasTrees) return;
    if (kind === "rural") at(17, 5.5, (x, y, _, r) => noise(x / 140, y / 140 + 3) > 0.5 && tree(x, y, r, 3.5));
    at(2.6, kind === "motorway" ? 9 : 7.5, (x, y, turn, r) => {
      if (noise(x / 75 + 11, y / 75) > 0.56)
        put("bush", x, y, turn + Math.PI / 2, [1 + r, 1 + r, 1.3 + 1.2 * r], LEAVES[Math.floor(r * 5)]!, 5);
    });
    for (const aside of [20, 34, 52, 75, 105, 140]) {
      at(9 + aside / 9, aside, (x, y, _, r) => {
        if (noise(x / 120 + 5, y / 120 + 9) > 0.58) tree(x + 6 * (r - 0.5), y + 6 * (hash(x, y) - 0.5), r, 12, 1.15);
      });
    }
    if (kind === "rural")
      at(
        260,
        60,
        (x, y, turn, r) => r > 0.45 && put("house", x, y, turn, [9, 11, 5.2], WALLS[Math.floor(r * WALLS.length)]!, 25),
      );
  });
  return found;
}

type At = (
  step: number,
  aside: number,
  use: (x: number, y: number, turn: number, r: number, z: number) => void,
) => void;
type Put = (
  what: Kind,
  x: number,
  y: number,
  turn: number,
  size: [number, number, number],
  colour: number,
  free: number,
) => void;

/** Rows of façades along the street, and taller houses behind. */
function houses(at: At, put: Put): void {
  at(15.5, 10.5, (x, y, turn, r) => {
    if (r < 0.08) return;
    const kind: Kind = r > 0.72 ? "office" : r > 0.38 ? "block" : "house";
    const high = kind === "house" ? 6 : kind === "block" ? 12.5 : 16 + 4 * r;
    put(kind, x, y, turn, [10, kind === "house" ? 11.5 : 15.2, high], WALLS[Math.floor(r * 997) % WALLS.length]!, 4.2);
  });
  at(21, 30, (x, y, turn, r) =>
    put(
      r > 0.5 ? "office" : "block",
      x,
      y,
      turn,
      [13, 18, 15 + 12 * r],
      WALLS[Math.floor(r * 613) % WALLS.length]!,
      18,
    ),
  );
}

const USED: Record<string, Kind> = {
  tree: "leafy",
  vegetation: "bush",
  building: "block",
  streetLamp: "lamp",
  pole: "lamp",
};
const NOT_DRAWN = new Set(["none", "crosswalk", "patch", "parkingSpace", "roadMark", "soundBarrier"]);

function fromObject({ kind, place: [x, y, z], heading, size: [length, width, height] }: StandingObject): Planted[] {
  if (NOT_DRAWN.has(kind)) return [];
  const used = USED[kind];
  const high = height || (used === "lamp" ? 6 : used === "block" ? 9 : used === "bush" ? 1.5 : used ? 8 : 1);
  const thick: [number, number, number] =
    used === "block" || !used ? [length || 0.4, width || 0.4, high] : [high, high, high];
  const colour =
    used === "leafy" || used === "bush" ? LEAVES[0]! : used === "block" ? WALLS[0]! : used ? 0xffffff : 0xa9acad;
  return [{ kind: used ?? "box", x, y, z, turn: heading, size: thick, colour }];
}

const matrix = new Matrix4();
const place = new Vector3();
const size = new Vector3();
const turned = new Quaternion();
const up = new Vector3(0, 0, 1);
const tint = new Color();
const view = new Frustum();
const ball = new Sphere();
