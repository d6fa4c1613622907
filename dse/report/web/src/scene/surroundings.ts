// Sky, light, fog, rain and snow as the weather of the run has them.
import {
  type BufferGeometry,
  CircleGeometry,
  Color,
  FogExp2,
  Mesh,
  RingGeometry,
  type Scene,
  type Vector3,
} from "three";
import type { Source, Strip } from "./data";
import { joined, LIT, painted } from "./light";
import { Falling } from "./precipitation";

const DAY = new Color(0xa9c8e8);
const OVERCAST = new Color(0xa3adb6);
const MIST = new Color(0xc9d0d4);
const NIGHT = new Color(0x101724);
const NOON = new Color(0xffffff);
const DULL = new Color(0xd6dade);
const MOON = new Color(0x434c5c);
const CLEAR = 0.0014; // 1/m without fog: where the land ends nothing must be seen
const DEEP = 40; // m below the eye at most, where the road has hills
const OUTSKIRTS = [40, 120, 360, 1100, 3300, 10000]; // m

export interface Surroundings {
  /** From above nothing is hidden. */
  show(time: number, eye: Vector3, above: boolean): void;
}

export function buildSurroundings(scene: Scene, source: Source): Surroundings {
  const land = new Mesh(ground(), LIT);
  // Drawn last, so that only what is seen of it costs anything.
  land.renderOrder = 1;
  const fog = new FogExp2(0xffffff, 0);
  scene.fog = fog;
  scene.background = new Color();
  scene.add(land);
  const lowest = lowestOf(source.document.strips);
  const rain = new Falling(true, 9);
  const snow = new Falling(false, 1.5);
  scene.add(rain.mesh, snow.mesh);
  return {
    show: (time, eye, above) => {
      const dark = source.at("weather.darkness", time);
      const falls = [source.at("weather.rain", time), source.at("weather.snow", time)] as const;
      const haze = source.at("weather.fog", time);
      const air = haze + veil(falls[0], 0.37e-3) + veil(falls[1], 3e-3);
      const dull = Math.min(1, air / 0.0015);
      const colour = DAY.clone()
        .lerp(OVERCAST, dull)
        .lerp(MIST, Math.min(1, haze / 0.01))
        .lerp(NIGHT, dark);
      (scene.background as Color).copy(colour);
      fog.color.copy(colour);
      fog.density = above ? 0 : Math.max(air, CLEAR);
      LIT.color.copy(NOON).lerp(DULL, dull).lerp(MOON, dark);
      land.position.set(eye.x, eye.y, (above ? lowest : Math.max(lowest, eye.z - DEEP)) - 0.06);
      rain.show(above ? 0 : falls[0], time, eye, 1 - dark);
      snow.show(above ? 0 : falls[1], time, eye, 1 - dark);
    },
  };
}

/** What falls takes from the sight, in 1/m: heavy rain lets one see 1.5 km, snow of as much water a tenth of that. */
function veil(rate: number, share: number): number {
  return share * (Math.max(rate, 0) * 3.6e6) ** 0.63;
}

function lowestOf(strips: Strip[]): number {
  let lowest = Infinity;
  for (const { left, right } of strips)
    for (const border of [left, right])
      for (let i = 2; i < border.length; i += 3) lowest = Math.min(lowest, border[i]!);
  return Number.isFinite(lowest) ? lowest : 0;
}

/** Finer the nearer: over one large triangle fog is not told exactly. */
function ground(): BufferGeometry {
  const rings = OUTSKIRTS.slice(1).map((outer, number) => new RingGeometry(OUTSKIRTS[number], outer, 24));
  return joined([new CircleGeometry(OUTSKIRTS[0], 24), ...rings].map((each) => painted(each, 0x8fb070)));
}
