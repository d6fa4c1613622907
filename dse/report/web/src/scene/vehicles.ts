// Road users as they are drawn: equal bodies at once, nearer ones finer; wheels, lamps, limbs and shadows of all at once.
import {
  BoxGeometry,
  type BufferGeometry,
  CapsuleGeometry,
  Color,
  CylinderGeometry,
  Euler,
  type Frustum,
  InstancedMesh,
  Matrix4,
  MeshBasicMaterial,
  Quaternion,
  type Scene,
  Sphere,
  Vector3,
} from "three";
import type { Body, Lamp } from "./bodies/body";
import { type Choice, chooseBody } from "./bodies/choose";
import { BODY, box, indexed, joined, LIT, painted } from "./light";
import type { Lamp as StreetLamp } from "./planting";
import { Glow, Shadows } from "./shadows";

const COLOURS = [0xb6362c, 0xe9e9e4, 0x878f97, 0x2f5f46, 0xcaa548, 0x3f4f9c, 0x6e4a68, 0x33373d, 0xc6cacf, 0x274a6d];
export const HOST_COLOUR = 0x2c66d8;
const LIT_BRAKE = new Color(0xff2418);
const TAIL = new Color(0xb01a12);
const HEAD = new Color(0xfff6dc);
const AMBER = new Color(0xffa318);
const NEAR = [26, 75]; // m up to which a body is drawn finely, and with wheels that turn
const NEAREST = -4; // drawn first: what is behind costs less
const SHADOW = 6; // m that one reaches beyond its body
const MOST_SHAPES = 96;
const STREET = 64; // street lamps that glow at once
const LAMPLIGHT = 260; // m
const POOLED = 130; // m up to which the ground is seen to be lit

/** One road user at a moment; the fleet draws what it is told by `add`. */
export interface Vehicle {
  choice: Choice;
  colour: Color;
  position: Vector3;
  /** Roll, pitch (nose down) and heading in rad. */
  rotation: Euler;
  /** m that the wheels have rolled; rad that the front ones are turned to the left. */
  rolled: number;
  steered: number;
  brakes: boolean;
  /** 1 to the left, -1 to the right, 0 for none. */
  indicates: number;
  /** Turns of arms and legs. */
  stride: number;
  /** Less than 1 for a walker who stands. */
  swing: number;
}

export function vehicleOf(choice: Choice, colour: number): Vehicle {
  const rotation = new Euler(0, 0, 0, "ZYX");
  const still = { rolled: 0, steered: 0, brakes: false, indicates: 0, stride: 0, swing: 1 };
  return { choice, colour: new Color(colour), position: new Vector3(), rotation, ...still };
}

export function buildOther(kind: string, id: number, length: number, width: number, height: number): Vehicle {
  return vehicleOf(chooseBody(kind, id, length, width, height), COLOURS[Math.abs(Math.round(id)) % COLOURS.length]!);
}

interface Shape {
  body: Body;
  levels: (InstancedMesh | null)[];
  used: number;
}

/** What is drawn finely, and what may be left out where pictures take long. */
export interface Detail {
  shadows: boolean;
  /** Multiplies the distances up to which bodies are fine. */
  reach: number;
}

export class Fleet {
  private readonly shapes = new Map<string, Shape>();
  private readonly wheels: InstancedMesh[];
  private readonly lamps: InstancedMesh;
  private readonly limbs: InstancedMesh;
  readonly shadows: Shadows;
  private readonly glow: Glow;
  private isDark = false;
  private time = 0;
  private pictures = 0;
  private readonly eye = new Vector3();
  private view: Frustum | null = null;
  private sight = Infinity;
  detail: Detail = { shadows: true, reach: 1 };

  constructor(
    private readonly scene: Scene,
    private readonly most: number,
  ) {
    this.wheels = [true, false].map((fine) => new InstancedMesh(indexed(wheel(fine)), LIT, 10 * most));
    this.lamps = new InstancedMesh(new BoxGeometry(0.03, 1, 1), new MeshBasicMaterial(), 8 * most);
    this.limbs = new InstancedMesh(
      painted(
        new CapsuleGeometry(0.5, 1, 2, 6)
          .rotateX(Math.PI / 2)
          .scale(1, 1, 0.5)
          .translate(0, 0, -0.5),
        0xffffff,
        0,
        0,
        0,
        [1, 0],
      ),
      BODY,
      4 * most,
    );
    for (const mesh of this.parts) {
      mesh.frustumCulled = false;
      mesh.renderOrder = NEAREST;
      mesh.setColorAt(0, HEAD);
      scene.add(mesh);
    }
    this.shadows = new Shadows(scene, most);
    this.glow = new Glow(scene, 4 * most + STREET);
    this.clear(false, 0, this.eye);
  }

  /** Whether it *isDark* decides on the lamps of those that come; *eye* on how finely they are drawn. What is outside of
   * *view* or beyond *sight* m is left out; null sees all around. */
  clear(isDark: boolean, time: number, eye: Vector3, view: Frustum | null = null, sight = Infinity): void {
    this.isDark = isDark;
    this.time = time;
    this.eye.copy(eye);
    this.view = view;
    this.sight = sight;
    this.pictures++;
    for (const mesh of this.parts) mesh.count = 0;
    for (const { levels } of this.shapes.values()) for (const mesh of levels) if (mesh) mesh.count = 0;
    this.shadows.clear();
    this.glow.clear();
  }

  private get parts(): InstancedMesh[] {
    return [...this.wheels, this.lamps, this.limbs];
  }

  add(vehicle: Vehicle): void {
    const shape = this.shapeOf(vehicle.choice);
    const { body } = shape;
    const away = vehicle.position.distanceTo(this.eye);
    ball.center.copy(vehicle.position);
    ball.radius = 0.5 * body.shade[0] + SHADOW;
    if (away > this.sight || this.view?.intersectsSphere(ball) === false) return;
    turned.setFromEuler(vehicle.rotation);
    whole.compose(vehicle.position, turned, unit);
    const far = away / this.detail.reach;
    const level = far < NEAR[0]! ? 0 : far < NEAR[1]! ? 1 : 2;
    const mesh = this.meshOf(shape, level);
    mesh.setColorAt(mesh.count, vehicle.colour);
    mesh.setMatrixAt(mesh.count++, whole);
    if (this.detail.shadows && far < 160) this.shadows.cast(vehicle, this.meshOf(shape, 2).geometry, body.shade);
    else this.shadows.patch(whole, body.shade);
    if (level < 2 || body.wheels.length < 3) this.turnWheels(vehicle, body, this.wheels[Math.min(level, 1)]!);
    this.swing(vehicle, body);
    this.light(vehicle, body, far);
  }

  /** Street lamps near the eye glow by night. */
  lightStreet(lamps: StreetLamp[]): void {
    if (!this.isDark) return;
    let count = 0;
    for (const { head, ground } of lamps) {
      const far = head.distanceTo(this.eye);
      if (far > LAMPLIGHT || count++ >= STREET) continue;
      this.glow.add(head, HEAD, 1);
      if (far < POOLED) this.glow.shine(head, ground);
    }
  }

  finish(): void {
    const meshes = this.parts;
    for (const { levels } of this.shapes.values()) for (const mesh of levels) if (mesh) meshes.push(mesh);
    for (const mesh of meshes) {
      mesh.visible = mesh.count > 0;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
    this.shadows.finish();
    this.glow.finish();
    if (this.shapes.size > MOST_SHAPES) this.forget();
  }

  private turnWheels(vehicle: Vehicle, { wheels }: Body, mesh: InstancedMesh): void {
    for (const { x, y, radius, width, isSteered } of wheels) {
      turn.setFromEuler(angles.set(0, vehicle.rolled / radius, isSteered ? vehicle.steered : 0, "ZYX"));
      this.put(mesh, place.set(x, y, radius), size.set(radius, width, radius), HEAD);
    }
  }

  private swing(vehicle: Vehicle, { limbs }: Body): void {
    for (const limb of limbs) {
      const held = limb.swing < 0;
      const angle = held
        ? limb.swing
        : limb.swing * vehicle.swing * Math.sin(2 * Math.PI * (vehicle.stride + limb.phase));
      turn.setFromEuler(angles.set(0, angle, 0, "ZYX"));
      if (limb.colour) tint.set(limb.colour);
      else tint.copy(vehicle.colour);
      this.put(this.limbs, place.set(...limb.place), size.set(limb.thick, limb.thick, limb.length), tint);
    }
  }

  private light(vehicle: Vehicle, { lamps }: Body, far: number): void {
    turn.identity();
    const isOn = this.time % 0.75 < 0.4;
    for (const lamp of lamps) {
      const colour = this.colourOf(vehicle, lamp, isOn);
      if (!colour) continue;
      this.put(this.lamps, place.set(...lamp.place), size.set(1, ...lamp.size), colour);
      if (this.isDark && far > 4)
        this.glow.add(place.set(...lamp.place).applyMatrix4(whole), colour, lamp.kind === "head" ? 1 : 0.6);
    }
  }

  private colourOf({ brakes, indicates }: Vehicle, { kind }: Lamp, isOn: boolean): Color | null {
    if (kind === "brake") return brakes ? LIT_BRAKE : this.isDark ? TAIL : null;
    if (kind === "head") return this.isDark ? HEAD : null;
    return isOn && indicates === (kind === "left" ? 1 : -1) ? AMBER : null;
  }

  private put(mesh: InstancedMesh, at: Vector3, scale: Vector3, colour: Color): void {
    if (mesh.count >= mesh.instanceMatrix.count) return;
    mesh.setColorAt(mesh.count, colour);
    mesh.setMatrixAt(mesh.count++, matrix.compose(at, turn, scale).premultiply(whole));
  }

  private shapeOf({ name, build }: Choice): Shape {
    const known = this.shapes.get(name) ?? { body: build(), levels: [null, null, null], used: 0 };
    known.used = this.pictures;
    this.shapes.set(name, known);
    return known;
  }

  private meshOf(shape: Shape, level: number): InstancedMesh {
    const known = shape.levels[level];
    if (known) return known;
    const mesh = new InstancedMesh(indexed(shape.body.levels[level]!()), BODY, this.most);
    mesh.frustumCulled = false;
    mesh.renderOrder = NEAREST;
    mesh.setColorAt(0, HEAD);
    mesh.count = 0;
    shape.levels[level] = mesh;
    this.scene.add(mesh);
    return mesh;
  }

  /** Gives back shapes that are not in the picture. */
  private forget(): void {
    for (const [name, { levels, used }] of this.shapes) {
      if (used === this.pictures) continue;
      for (const mesh of levels) {
        if (!mesh) continue;
        this.scene.remove(mesh);
        mesh.geometry.dispose();
        mesh.dispose();
      }
      this.shapes.delete(name);
    }
  }
}

/** A tyre with a rim of five spokes, of radius and width 1; from afar a tyre with a disc. */
function wheel(fine: boolean): BufferGeometry {
  const tyre = painted(new CylinderGeometry(1, 1, 1, fine ? 20 : 12, 1), 0x191a1c);
  if (!fine) return joined([tyre, painted(new CylinderGeometry(0.64, 0.64, 1.04, 8, 1), 0x8d9398)]);
  const rim = painted(new CylinderGeometry(0.66, 0.66, 1.03, 20, 1), 0x50565c);
  const spokes = [0, 1, 2, 3, 4].map((i) =>
    painted(
      new BoxGeometry(0.6, 1.07, 0.15).translate(0.33, 0, 0).rotateY((2 * Math.PI * i) / 5),
      0xc3c9ce,
      0,
      0,
      0,
      [0, 0.3],
    ),
  );
  return joined([tyre, rim, ...spokes, box([0.22, 1.09, 0.22], 0x70767c, [0, 0, 0])]);
}

const angles = new Euler();
const turned = new Quaternion();
const turn = new Quaternion();
const place = new Vector3();
const size = new Vector3();
const unit = new Vector3(1, 1, 1);
const matrix = new Matrix4();
const whole = new Matrix4();
const tint = new Color();
const ball = new Sphere();
