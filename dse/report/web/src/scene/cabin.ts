// Inside the car, in the axes of its centre of gravity: dashboard, steering wheel, pillars, and mirrors that show the road.
import {
  Color,
  CylinderGeometry,
  Group,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  type Scene,
  TorusGeometry,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { buildBonnet } from "./bodies/cars";
import { type HalfRing, loft } from "./bodies/loft";
import type { Document } from "./data";
import { BODY, box, joined, LIT, painted, type Surface } from "./light";

/** The driver's eye in m ahead, to the left, over the road; before the roof's front edge. */
export const EYE: [number, number, number] = [-0.08, 0.36, 1.22];
const RATIO = 15; // of the steering wheel to the front wheels
/** Nothing lies on it. */
const DRY: Surface = [1, 0];
const PLASTIC = 0x23262a;
const SOFT = 0x2c3035;
const WHEEL: [number, number, number] = [0.5, 0.36, 0.86];

export interface Cabin {
  group: Group;
  /** Turns the steering wheel with the front wheels, to *steering* rad. */
  show(steering: number): void;
  /** Draws what the mirrors show; *prepare* is told the camera that looks back. */
  mirror(renderer: WebGLRenderer, scene: Scene, car: Group, prepare: (back: PerspectiveCamera) => void): void;
  /** Without mirrors. */
  dull(): void;
  close(): void;
}

export function buildCabin(
  { length, width, front, wheel: radius }: Document["host"],
  height: number,
  colour: number,
): Cabin {
  const group = new Group();
  const middle = front - length / 2;
  const cowl = middle + 0.19 * length;
  group.add(new Mesh(joined([dashboard(middle, length), ...pillars(middle, length)]), LIT));
  const bonnet = new InstancedMesh(buildBonnet(length, width, height, radius), BODY, 1);
  bonnet.setMatrixAt(0, new Matrix4().makeTranslation(middle, 0, 0));
  bonnet.setColorAt(0, new Color(colour));
  bonnet.frustumCulled = false;
  group.add(bonnet);
  const wheel = new Mesh(
    joined([
      painted(new TorusGeometry(0.185, 0.017, 8, 28), 0x17191b, 0, 0, 0, DRY),
      box([0.3, 0.05, 0.03], PLASTIC, [0, 0, 0], 0, DRY),
      box([0.05, 0.18, 0.03], PLASTIC, [0, -0.09, 0], 0, DRY),
      painted(new CylinderGeometry(0.06, 0.07, 0.05, 12).rotateX(Math.PI / 2), SOFT, 0, 0, 0, DRY),
    ]),
    LIT,
  );
  const column = new Group();
  column.add(wheel);
  column.position.set(...WHEEL);
  // Its axis points to the driver and up.
  column.rotation.set(0, -1.15, 0);
  wheel.rotation.order = "ZYX";
  group.add(column);
  const target = new WebGLRenderTarget(512, 128);
  const glass = new MeshBasicMaterial({ map: target.texture, fog: false });
  const camera = new PerspectiveCamera(26, 4, 0.5, 900);
  camera.up.set(0, 0, 1);
  const mirrors = [
    mirror(glass, [0.62, 0.05, 1.4], [0.21, 0.06], [0.28, 0.72], 0.2),
    mirror(glass, [cowl - 0.02, width / 2 + 0.06, 1.01], [0.18, 0.12], [0.66, 1], 0.3),
    mirror(glass, [cowl - 0.02, -width / 2 - 0.06, 1.01], [0.18, 0.12], [0, 0.34], -0.5),
  ];
  for (const each of mirrors) group.add(each);
  // Drawn first: what is behind costs less.
  group.traverse((each) => (each.renderOrder = -9));
  return {
    group,
    show: (steering) => (wheel.rotation.z = RATIO * steering),
    dull: () => {
      for (const each of mirrors) each.visible = false;
    },
    mirror: (renderer, scene, car, prepare) => {
      for (const each of mirrors) each.visible = true;
      const place = car.localToWorld(camera.position.set(front - length - 0.1, 0, 1.25));
      camera.lookAt(car.localToWorld(place.clone().set(front - length - 30, 0, 0.9)));
      camera.updateMatrixWorld();
      prepare(camera);
      group.visible = false;
      renderer.setRenderTarget(target);
      renderer.render(scene, camera);
      renderer.setRenderTarget(null);
      group.visible = true;
    },
    close: () => target.dispose(),
  };
}

/** Its upper side rises from the windscreen to the hood over the instruments. */
function dashboard(middle: number, length: number) {
  const cowl = middle + 0.19 * length;
  const half = (top: number, low: number): HalfRing => [
    [0, low],
    [0.74, low],
    [0.76, top - 0.06],
    [0.7, top],
    [0, top + 0.005],
  ];
  const shell = loft(
    [
      { x: 0.5, half: half(0.62, 0.3) },
      { x: 0.55, half: half(0.9, 0.3) },
      { x: 0.72, half: half(0.955, 0.4) },
      { x: cowl, half: half(0.968, 0.4) },
    ],
    () => [PLASTIC, DRY],
  );
  const hood = loft(
    [
      {
        x: 0.5,
        half: [
          [0, 0.86],
          [0.17, 0.86],
          [0.19, 0.95],
          [0.13, 0.995],
          [0, 1.002],
        ],
      },
      {
        x: 0.66,
        half: [
          [0, 0.86],
          [0.16, 0.86],
          [0.17, 0.93],
          [0.12, 0.96],
          [0, 0.965],
        ],
      },
    ],
    () => [SOFT, DRY],
  );
  hood.translate(0, 0.36, 0);
  return joined([shell, hood, box([0.03, 0.24, 0.13], 0x0c0e10, [0.5, 0, 0.86], 0, DRY)]);
}

function pillars(middle: number, length: number) {
  const [foot, head] = [middle + 0.19 * length, middle + 0.055 * length];
  return [1, -1].flatMap((side) => {
    const pillar = box([Math.hypot(foot - head, 0.42) + 0.06, 0.035, 0.045], PLASTIC, [0, 0, 0], 0, DRY);
    pillar.rotateY(Math.atan2(0.42, foot - head));
    pillar.rotateZ(-side * 0.16);
    pillar.translate((foot + head) / 2 + 0.04, side * 0.71, 1.13);
    return [pillar, box([1.6, 0.08, 0.09], PLASTIC, [0.1, side * 0.83, 0.86], 0, DRY)];
  });
}

/** A plane that faces the driver and shows the share of the picture behind the car between *from* and *to*. */
function mirror(
  glass: MeshBasicMaterial,
  place: [number, number, number],
  [wide, tall]: [number, number],
  [from, to]: [number, number],
  turn: number,
): Group {
  const plane = new PlaneGeometry(wide, tall);
  const uv = plane.getAttribute("uv");
  // Left and right are swapped, as in a mirror.
  for (let i = 0; i < uv.count; i++) uv.setX(i, to + uv.getX(i) * (from - to));
  plane.rotateX(Math.PI / 2).rotateZ(-Math.PI / 2);
  const group = new Group();
  const frame = new Mesh(box([0.05, wide + 0.02, tall + 0.02], 0x141618, [0.03, 0, 0], 0, DRY), LIT);
  group.add(new Mesh(plane, glass), frame);
  group.position.set(...place);
  group.rotation.z = turn;
  return group;
}
