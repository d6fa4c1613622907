// What lies under road users: shadows that the sun throws on the road, soft patches without one; and the glow of lamps.
import {
  AdditiveBlending,
  AlwaysStencilFunc,
  BufferGeometry,
  CanvasTexture,
  type Color,
  Float32BufferAttribute,
  InstancedMesh,
  KeepStencilOp,
  Matrix4,
  MeshBasicMaterial,
  NotEqualStencilFunc,
  PlaneGeometry,
  Points,
  PointsMaterial,
  Quaternion,
  ReplaceStencilOp,
  type Scene,
  Vector3,
} from "three";
import { AIR } from "./light";
import type { Vehicle } from "./vehicles";

const LIFT = 0.06; // m over the road
const POOL = 17; // m of ground that a street lamp lights
const POOLS = 24;

/** A body pressed flat along the sun's rays. Where two overlap it is no darker: the stencil keeps what was darkened. */
export class Shadows {
  private readonly material = new MeshBasicMaterial({
    color: 0x0a0f18,
    transparent: true,
    opacity: 0.42,
    depthWrite: false,
    stencilWrite: true,
    stencilRef: 1,
    stencilFunc: NotEqualStencilFunc,
    stencilZPass: ReplaceStencilOp,
    stencilFail: KeepStencilOp,
    stencilZFail: KeepStencilOp,
  });
  private readonly meshes = new Map<BufferGeometry, InstancedMesh>();
  private readonly patches: InstancedMesh;

  constructor(
    private readonly scene: Scene,
    private readonly most: number,
  ) {
    const soft = new MeshBasicMaterial({
      color: 0x000000,
      map: blot(),
      transparent: true,
      opacity: 0.55,
      depthWrite: false,
    });
    soft.stencilFunc = AlwaysStencilFunc;
    this.patches = new InstancedMesh(new PlaneGeometry(1, 1), soft, most);
    this.patches.frustumCulled = false;
    this.patches.renderOrder = 1;
    scene.add(this.patches);
  }

  clear(): void {
    this.patches.count = 0;
    for (const mesh of this.meshes.values()) mesh.count = 0;
  }

  /** The shadow of *vehicle*, whose mesh is *geometry*. */
  cast({ position, rotation }: Vehicle, geometry: BufferGeometry, shade: [number, number]): void {
    turned.setFromEuler(rotation);
    whole.compose(position, turned, unit);
    this.patch(whole, shade);
    const sun = AIR.sunDirection.value;
    if (AIR.sunShare.value < 0.25 || sun.z < 0.08) return;
    let mesh = this.meshes.get(geometry);
    if (!mesh) {
      mesh = new InstancedMesh(geometry, this.material, this.most);
      mesh.frustumCulled = false;
      mesh.renderOrder = 2;
      this.meshes.set(geometry, mesh);
      this.scene.add(mesh);
      geometry.addEventListener("dispose", () => this.drop(geometry));
    }
    const ground = position.z + LIFT;
    const [kx, ky] = [sun.x / Math.max(sun.z, 0.2), sun.y / Math.max(sun.z, 0.2)];
    // x - (z - ground) kx, y - (z - ground) ky, ground
    flat.set(1, 0, -kx, kx * ground, 0, 1, -ky, ky * ground, 0, 0, 0, ground, 0, 0, 0, 1);
    mesh.setMatrixAt(mesh.count++, whole.premultiply(flat));
  }

  /** A soft patch under a body at *at*. */
  patch(at: Matrix4, [length, width]: [number, number]): void {
    matrix
      .makeScale(1.12 * length, 1.3 * width, 1)
      .premultiply(lifted)
      .premultiply(at);
    this.patches.setMatrixAt(this.patches.count++, matrix);
  }

  finish(): void {
    this.material.opacity = 0.46 * AIR.sunShare.value;
    for (const mesh of [this.patches, ...this.meshes.values()]) {
      mesh.visible = mesh.count > 0;
      mesh.instanceMatrix.needsUpdate = true;
    }
  }

  private drop(geometry: BufferGeometry): void {
    const mesh = this.meshes.get(geometry);
    if (!mesh) return;
    this.scene.remove(mesh);
    mesh.dispose();
    this.meshes.delete(geometry);
  }
}

/** Lamps by night, seen from afar: round spots of light. */
export class Glow {
  private readonly points: Points;
  private readonly pools: InstancedMesh;
  private count = 0;

  constructor(
    scene: Scene,
    private readonly most: number,
  ) {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(new Float32Array(3 * most), 3));
    geometry.setAttribute("color", new Float32BufferAttribute(new Float32Array(3 * most), 3));
    const material = new PointsMaterial({
      size: 1.5,
      map: blot(true),
      vertexColors: true,
      transparent: true,
      depthWrite: false,
      blending: AdditiveBlending,
      opacity: 0.8,
    });
    this.points = new Points(geometry, material);
    this.points.frustumCulled = false;
    this.points.renderOrder = 5;
    const pool = new MeshBasicMaterial({
      color: 0x5c5138,
      map: blot(true),
      transparent: true,
      depthWrite: false,
      blending: AdditiveBlending,
    });
    this.pools = new InstancedMesh(new PlaneGeometry(POOL, POOL), pool, POOLS);
    this.pools.frustumCulled = false;
    this.pools.renderOrder = 1;
    scene.add(this.points, this.pools);
  }

  clear(): void {
    this.count = 0;
    this.pools.count = 0;
  }

  /** The light on the *ground* under a street lamp at *place*. */
  shine(place: Vector3, ground: number): void {
    if (this.pools.count >= POOLS) return;
    this.pools.setMatrixAt(this.pools.count++, matrix.makeTranslation(place.x, place.y, ground + 0.1));
  }

  add(place: Vector3, colour: Color, share: number): void {
    if (this.count >= this.most) return;
    const { position, color } = this.points.geometry.attributes as Record<string, Float32BufferAttribute>;
    position!.setXYZ(this.count, place.x, place.y, place.z);
    color!.setXYZ(this.count++, colour.r * share, colour.g * share, colour.b * share);
  }

  finish(): void {
    this.pools.visible = this.pools.count > 0;
    this.pools.instanceMatrix.needsUpdate = true;
    this.points.visible = this.count > 0;
    this.points.geometry.setDrawRange(0, this.count);
    this.points.geometry.attributes.position!.needsUpdate = true;
    this.points.geometry.attributes.color!.needsUpdate = true;
  }
}

/** A round spot that fades outwards: white on black to be added, else by its opacity. */
export function blot(isLight = false): CanvasTexture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d")!;
  const fade = pen.createRadialGradient(32, 32, isLight ? 1 : 10, 32, 32, 32);
  fade.addColorStop(0, isLight ? "rgb(255 255 255)" : "rgb(255 255 255 / 100%)");
  if (isLight) fade.addColorStop(0.2, "rgb(255 255 255 / 55%)");
  fade.addColorStop(1, "rgb(255 255 255 / 0%)");
  pen.fillStyle = fade;
  pen.fillRect(0, 0, 64, 64);
  return new CanvasTexture(canvas);
}

const turned = new Quaternion();
const whole = new Matrix4();
const flat = new Matrix4();
const matrix = new Matrix4();
const lifted = new Matrix4().makeTranslation(0, 0, 0.05);
const unit = new Vector3(1, 1, 1);
