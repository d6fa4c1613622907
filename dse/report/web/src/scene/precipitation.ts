// Rain and snow: drops that stand in the world while the eye goes through them, so that they come towards who drives.
import {
  BufferGeometry,
  Float32BufferAttribute,
  LineBasicMaterial,
  LineSegments,
  Points,
  PointsMaterial,
  Vector3,
} from "three";
import { blot } from "./shadows";

const MANY = 2000;
const SPREAD = 22; // m of the cube around the eye that is full of them
const HEAVY = 20e-3 / 3600; // m/s: 20 mm/h
const SEEN = 1 / 35; // s that a drop is drawn over
const QUICKEST = 100; // m/s; an eye that moves more has jumped

export class Falling {
  readonly mesh: LineSegments | Points;
  private readonly drops = new Float32Array(3 * MANY);
  private readonly eye = new Vector3();
  private readonly streak = new Vector3();
  private last = 0;

  constructor(
    private readonly isLong: boolean,
    private readonly speed: number,
  ) {
    let seed = 1;
    const next = (): number => {
      seed = (seed * 16807) % 2147483647;
      return seed / 2147483647;
    };
    for (let i = 0; i < this.drops.length; i++) this.drops[i] = next() * SPREAD;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(new Float32Array((isLong ? 6 : 3) * MANY), 3));
    this.mesh = isLong
      ? new LineSegments(
          geometry,
          new LineBasicMaterial({ color: 0xe2eaf2, transparent: true, opacity: 0.5, fog: false }),
        )
      : new Points(
          geometry,
          new PointsMaterial({ map: blot(), transparent: true, depthWrite: false, size: 0.075, fog: false }),
        );
    this.mesh.frustumCulled = false;
  }

  /** What falls at *time* (s) where *rate* m/s of water come down, seen from *eye*, in the light of *brightness* 0 ... 1. */
  show(rate: number, time: number, eye: Vector3, brightness: number): void {
    this.mesh.visible = rate > 0;
    if (!this.mesh.visible) return;
    this.move(time, eye);
    // As dense as it looks: twice the rain has bigger drops, too, rather than twice as many.
    const count = Math.ceil(MANY * Math.min(1, Math.sqrt(rate / HEAVY)));
    const places = this.mesh.geometry.getAttribute("position");
    const down = eye.z + this.speed * time;
    const step = this.isLong ? 2 : 1;
    for (let i = 0; i < count; i++) {
      const x = around(this.drops[3 * i]! - eye.x);
      const y = around(this.drops[3 * i + 1]! - eye.y);
      const z = around(this.drops[3 * i + 2]! - down);
      places.setXYZ(step * i, x, y, z);
      if (this.isLong) places.setXYZ(step * i + 1, x + this.streak.x, y + this.streak.y, z + this.streak.z);
    }
    places.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, step * count);
    this.mesh.position.copy(eye);
    if (this.mesh.material instanceof LineBasicMaterial) this.mesh.material.opacity = 0.2 + 0.35 * brightness;
  }

  /** The way of a drop against the eye while it is seen. */
  private move(time: number, eye: Vector3): void {
    const passed = time - this.last;
    if (passed !== 0) {
      this.streak.subVectors(eye, this.eye).multiplyScalar(SEEN / passed);
      if (!(passed > 0) || this.streak.length() > QUICKEST * SEEN) this.streak.set(0, 0, 0);
      this.streak.z += this.speed * SEEN;
    }
    this.eye.copy(eye);
    this.last = time;
  }
}

function around(way: number): number {
  return way - SPREAD * Math.floor(way / SPREAD) - SPREAD / 2;
}
