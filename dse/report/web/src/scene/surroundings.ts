// Sky, light, fog, rain and snow as the weather of the run has them.
import {
  BufferGeometry,
  Color,
  Float32BufferAttribute,
  FogExp2,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  PlaneGeometry,
  Points,
  PointsMaterial,
  type Scene,
  type Vector3,
} from "three";
import type { Source } from "./data";
import { LIT, painted } from "./light";

const DAY = new Color(0xa9c8e8);
const MIST = new Color(0xc9d0d4);
const NIGHT = new Color(0x0b1018);
const NOON = new Color(0xffffff);
const MOON = new Color(0x2c3240);
const MANY = 1500;
const SPREAD = 24;
const HEAVY = 20e-3 / 3600; // m/s: 20 mm/h

export interface Surroundings {
  /** From above nothing is hidden. */
  show(time: number, eye: Vector3, above: boolean): void;
}

export function buildSurroundings(scene: Scene, source: Source): Surroundings {
  const land = new Mesh(painted(new PlaneGeometry(20000, 20000), 0x8fb070), LIT);
  // Drawn last, so that only what is seen of it costs anything.
  land.renderOrder = 1;
  const fog = new FogExp2(0xffffff, 0);
  scene.fog = fog;
  scene.background = new Color();
  scene.add(land);
  const rain = drops(true);
  const snow = drops(false);
  scene.add(rain, snow);
  return {
    show: (time, eye, above) => {
      const dark = source.at("weather.darkness", time);
      const haze = source.at("weather.fog", time);
      const colour = DAY.clone().lerp(MIST, Math.min(1, haze / 0.01)).lerp(NIGHT, dark);
      (scene.background as Color).copy(colour);
      fog.color.copy(colour);
      // exp(-(d s)^2) and exp(-a d) are equal at the meteorological visibility 3 / a.
      fog.density = above ? 0 : Math.max(haze / Math.sqrt(3), 0.0012);
      LIT.color.copy(NOON).lerp(MOON, dark);
      land.position.set(eye.x, eye.y, -0.06 + Math.min(0, eye.z - 40));
      fall(rain, source.at("weather.rain", time), time, eye, 9);
      fall(snow, source.at("weather.snow", time), time, eye, 1.5);
    },
  };
}

type Falling = LineSegments | Points;

function drops(long: boolean): Falling {
  const points: number[] = [];
  let seed = 1;
  const next = (): number => (seed = (seed * 16807) % 2147483647) / 2147483647;
  for (let i = 0; i < MANY; i++) {
    const [x, y, z] = [(next() - 0.5) * 2 * SPREAD, (next() - 0.5) * 2 * SPREAD, next() * SPREAD];
    points.push(x, y, z);
    if (long) points.push(x, y, z + 0.35);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  const made = long
    ? new LineSegments(geometry, new LineBasicMaterial({ color: 0xaebbc8, transparent: true, opacity: 0.5 }))
    : new Points(geometry, new PointsMaterial({ color: 0xffffff, size: 0.09 }));
  made.frustumCulled = false;
  return made;
}

function fall(drops: Falling, rate: number, time: number, eye: Vector3, speed: number): void {
  drops.visible = rate > 0;
  if (!drops.visible) return;
  const each = drops instanceof LineSegments ? 2 : 1;
  drops.geometry.setDrawRange(0, each * Math.ceil(MANY * Math.min(1, rate / HEAVY)));
  drops.position.set(eye.x, eye.y, eye.z - SPREAD / 2 - ((time * speed) % SPREAD) / 2);
}
