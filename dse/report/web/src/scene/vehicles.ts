// Road users: simple bodies of their own length, width and height, so that what a sensor meets is what is seen.
import { BoxGeometry, CapsuleGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, MeshLambertMaterial, type Object3D } from "three";

const GLASS = 0x20262e;
const TYRE = 0x14161a;
const COLOURS = [0xb9402c, 0xd8d8d2, 0x6d7781, 0x3d6b4f, 0xc9a13b, 0x4d5fa8, 0x7b4a6d, 0x2f3338];

export interface Vehicle {
  group: Group;
  /** Turned about their axles (rad), and the front ones to the left. */
  wheels(spun: number, steered: number): void;
  brake(lit: boolean): void;
}

export function buildHost(length: number, width: number): Vehicle {
  return car(0x2458c8, length, width, 1.5);
}

export function buildOther(kind: string, id: number, length: number, width: number, height: number): Vehicle {
  const colour = COLOURS[Math.abs(id) % COLOURS.length]!;
  if (kind === "truck") return truck(colour, length, width, height);
  if (kind === "pedestrian") return standing(pedestrian(colour, height));
  if (kind === "bicycle" || kind === "motorcycle") return standing(rider(colour, length, height));
  if (kind === "obstacle") return standing(box(length, width, height, 0xd08030, height / 2));
  return car(colour, length, width, height);
}

function car(colour: number, length: number, width: number, height: number): Vehicle {
  const group = new Group();
  const radius = Math.min(0.33, height / 4);
  const body = box(length, width, height * 0.42, colour, radius + height * 0.19);
  const cabin = box(length * 0.5, width * 0.86, height * 0.36, GLASS, height - height * 0.19);
  cabin.position.x = -length * 0.05;
  const roof = box(length * 0.42, width * 0.84, 0.05, colour, height);
  roof.position.x = -length * 0.06;
  group.add(body, cabin, roof);
  return rolling(group, length, width, radius, length * 0.3, height * 0.45);
}

function truck(colour: number, length: number, width: number, height: number): Vehicle {
  const group = new Group();
  const cab = Math.min(2.4, length * 0.3);
  const load = box(length - cab - 0.3, width, height * 0.78, 0xdedede, height * 0.61);
  load.position.x = -(cab + 0.3) / 2;
  const front = box(cab, width, height * 0.7, colour, height * 0.5);
  front.position.x = (length - cab) / 2;
  group.add(load, front);
  return rolling(group, length, width, 0.5, length * 0.36, height * 0.3);
}

function rolling(group: Group, length: number, width: number, radius: number, axle: number, lamp: number): Vehicle {
  const front: Object3D[] = [];
  const spinning: Object3D[] = [];
  for (const [x, side] of [[axle, 1], [axle, -1], [-axle, 1], [-axle, -1]] as const) {
    const turn = new Group();
    const wheel = new Group();
    wheel.add(new Mesh(new CylinderGeometry(radius, radius, 0.24, 16), new MeshLambertMaterial({ color: TYRE })));
    wheel.add(new Mesh(new BoxGeometry(1.5 * radius, 0.26, 0.09), new MeshLambertMaterial({ color: 0xa8adb4 })));
    turn.position.set(x, side * (width / 2 - 0.13), radius);
    turn.add(wheel);
    if (x > 0) front.push(turn);
    spinning.push(wheel);
    group.add(turn);
  }
  const lamps = [1, -1].map((side) => {
    const mesh = new Mesh(new BoxGeometry(0.06, 0.3, 0.14), new MeshBasicMaterial({ color: 0x6a1512 }));
    mesh.position.set(-length / 2, side * (width / 2 - 0.25), lamp);
    group.add(mesh);
    return mesh;
  });
  group.add(shade(length, width));
  return {
    group,
    wheels: (spun, steered) => {
      for (const wheel of spinning) wheel.rotation.y = spun;
      for (const wheel of front) wheel.rotation.z = steered;
    },
    brake: (lit) => {
      for (const each of lamps) (each.material as MeshBasicMaterial).color.set(lit ? 0xff2a1c : 0x6a1512);
    },
  };
}

function pedestrian(colour: number, height: number): Group {
  const group = new Group();
  const body = new Mesh(new CapsuleGeometry(0.2, height * 0.55, 4, 8), new MeshLambertMaterial({ color: colour }));
  body.rotation.x = Math.PI / 2;
  body.position.z = height * 0.42;
  const head = new Mesh(new CapsuleGeometry(0.12, 0.04, 4, 8), new MeshLambertMaterial({ color: 0xd9a98a }));
  head.position.z = height - 0.14;
  group.add(body, head, shade(0.6, 0.6));
  return group;
}

function rider(colour: number, length: number, height: number): Group {
  const group = new Group();
  for (const x of [length * 0.33, -length * 0.33]) {
    const wheel = new Mesh(new CylinderGeometry(0.32, 0.32, 0.08, 16), new MeshLambertMaterial({ color: TYRE }));
    wheel.position.set(x, 0, 0.32);
    group.add(wheel);
  }
  const person = pedestrian(colour, height * 0.8);
  person.position.z = height * 0.2;
  group.add(box(length * 0.6, 0.1, 0.12, colour, 0.6), person);
  return group;
}

function standing(body: Object3D): Vehicle {
  const group = new Group();
  group.add(body);
  return { group, wheels: () => undefined, brake: () => undefined };
}

function box(length: number, width: number, height: number, colour: number, middle: number): Mesh {
  const mesh = new Mesh(new BoxGeometry(length, width, height), new MeshLambertMaterial({ color: colour }));
  mesh.position.z = middle;
  return mesh;
}

// A dark patch below costs nothing; shadows that are computed halve the frames without a graphics card.
function shade(length: number, width: number): Mesh {
  const material = new MeshBasicMaterial({ color: 0x000000, transparent: true, opacity: 0.35 });
  const mesh = new Mesh(new BoxGeometry(length * 1.04, width * 1.1, 0.01), material);
  mesh.position.z = 0.07;
  return mesh;
}
