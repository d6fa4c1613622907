// Sky with sun and clouds, fog, rain and snow, and what the weather does to all light.
import {
  CanvasTexture,
  Color,
  FogExp2,
  Mesh,
  MeshBasicMaterial,
  type Scene,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  type Vector3,
} from "three";
import type { Source } from "./data";
import { AIR, ALL_LIT } from "./light";
import { Falling } from "./precipitation";
import { noise } from "./random";

const DAY = new Color(0xc9dcec);
const OVERCAST = new Color(0xb4bcc3);
const MIST = new Color(0xc9d0d4);
const NIGHT = new Color(0x0d131f);
const NOON = new Color(0xffffff);
const DULL = new Color(0xd0d5db);
const MOON = new Color(0x2e3644);
const ZENITH = new Color(0x4d86cc);
const CLEAR = 0.0007; // 1/m without fog: where the land ends nothing must be seen
const RADIUS = 2400;
const HEAVY_RAIN = 2e-3 / 3600; // m/s that wet a road for good
const LAYING_SNOW = 1e-3 / 3600;
const USUAL_SUN = [-0.7, 0.72] as const; // azimuth, elevation in rad where the run has no sun

export interface Sky {
  /** How much of the light the air takes, in 1/m; from above nothing is hidden. */
  show(time: number, eye: Vector3, above: boolean): number;
}

export function buildSky(scene: Scene, source: Source): Sky {
  const fog = new FogExp2(0xffffff, 0);
  scene.fog = fog;
  const background = new Color();
  scene.background = background;
  const material = new MeshBasicMaterial({ map: clouds(), fog: false, depthWrite: false, transparent: true });
  const dome = new Mesh(
    new SphereGeometry(RADIUS, 32, 10, 0, 2 * Math.PI, 0, 0.53 * Math.PI).rotateX(Math.PI / 2).scale(-1, 1, 1),
    material,
  );
  // Behind everything, and after it: only what is seen of it costs anything.
  dome.renderOrder = 3;
  const sun = new Sprite(
    new SpriteMaterial({ map: disc(), fog: false, depthWrite: false, transparent: true, blending: 2 }),
  );
  sun.scale.set(420, 420, 1);
  sun.renderOrder = 4;
  const rain = new Falling(true, 9);
  const snow = new Falling(false, 1.5);
  scene.add(dome, sun, rain.mesh, snow.mesh);
  const [air, tone] = [new Color(), new Color()];
  return {
    show: (time, eye, above) => {
      const at = (name: string): number => source.at(`weather.${name}`, time);
      const [dark, haze, wet, white] = [at("darkness"), at("fog"), Math.max(at("rain"), 0), Math.max(at("snow"), 0)];
      const thick = haze + veil(wet, 0.37e-3) + veil(white, 3e-3);
      const dull = Math.min(1, Math.max(thick / 0.0015, covered(wet + white)));
      placeSun(source, time, dark);
      AIR.sunShare.value = (1 - dull) * (1 - Math.min(1, 2 * dark));
      AIR.wetness.value = source.has("weather.water")
        ? Math.max(Math.min(1, at("water") / 0.4e-3), Math.min(1, wet / HEAVY_RAIN))
        : Math.min(1, wet / HEAVY_RAIN);
      AIR.snowCover.value = Math.min(1, Math.sqrt(white / LAYING_SNOW));
      air
        .copy(DAY)
        .lerp(OVERCAST, dull)
        .lerp(MIST, Math.min(1, haze / 0.01));
      AIR.horizon.value.copy(air);
      AIR.zenith.value.copy(ZENITH).lerp(air, dull);
      air.lerp(NIGHT, dark);
      background.copy(air);
      fog.color.copy(air);
      fog.density = above ? 0 : Math.max(thick, CLEAR);
      tone.copy(NOON).lerp(DULL, dull).lerp(MOON, dark);
      for (const each of ALL_LIT) each.color.copy(tone);
      dome.visible = !above && dull < 0.95;
      dome.position.set(eye.x, eye.y, eye.z - 40);
      material.opacity = 1 - dull;
      material.transparent = dull > 0;
      material.color.setRGB(1, 1, 1).lerp(NIGHT, 0.93 * dark);
      sun.visible = !above && AIR.sunShare.value > 0.05;
      sun.material.opacity = AIR.sunShare.value;
      sun.position
        .copy(AIR.sunDirection.value)
        .multiplyScalar(0.9 * RADIUS)
        .add(eye);
      rain.show(above ? 0 : wet, time, eye, 1 - dark);
      snow.show(above ? 0 : white, time, eye, 1 - dark);
      return fog.density;
    },
  };
}

function placeSun(source: Source, time: number, dark: number): void {
  const known = source.has("weather.elevation") && source.at("weather.elevation", time) > 0.05;
  const azimuth = known ? source.angle("weather.azimuth", time) : USUAL_SUN[0];
  const elevation = known ? source.at("weather.elevation", time) : USUAL_SUN[1];
  const flat = Math.cos(elevation);
  AIR.sunDirection.value.set(
    flat * Math.cos(azimuth),
    flat * Math.sin(azimuth),
    Math.max(Math.sin(elevation), dark > 0.5 ? 0.5 : 0.05),
  );
}

/** What falls takes from the sight, in 1/m: heavy rain lets one see 1.5 km, snow of as much water a tenth of that. */
function veil(rate: number, share: number): number {
  return share * (Math.max(rate, 0) * 3.6e6) ** 0.63;
}

/** Which part of the sky is covered where so much falls, in m/s of water: half for a drizzle of 0.1 mm/h. */
function covered(rate: number): number {
  return Math.min(0.94, (rate * 3.6e6) ** 0.3);
}

/** The dome from the zenith (above) to below the horizon, with fair-weather clouds. */
function clouds(): CanvasTexture {
  const canvas = document.createElement("canvas");
  const [width, height] = [1024, 256];
  canvas.width = width;
  canvas.height = height;
  const pen = canvas.getContext("2d")!;
  const image = pen.createImageData(width, height);
  const [high, low] = [ZENITH, DAY];
  for (let y = 0; y < height; y++) {
    const elevation = Math.max(0, 1 - y / (0.94 * height)); // 1 above
    const up = elevation ** 0.55;
    for (let x = 0; x < width; x++) {
      // Clouds are flatter the nearer to the horizon, as seen from below a layer.
      const angle = (2 * Math.PI * x) / width;
      const far = 1 / Math.max(0.06, elevation);
      const [u, v] = [far * Math.cos(angle) * 1.6, far * Math.sin(angle) * 1.6];
      let dense = 0;
      for (let octave = 0, size = 1; octave < 4; octave++, size *= 2.1)
        dense += noise(u * size + 31 * octave, v * size) / size;
      const cover =
        Math.max(0, Math.min(1, (dense - 0.98) * 2.4)) * Math.max(0, Math.min(1, (elevation - 0.07) * 6)) * 0.85;
      const place = 4 * (y * width + x);
      const part = (a: number, b: number, white: number): number =>
        255 * ((b + (a - b) * up) * (1 - cover) + white * cover);
      image.data[place] = part(high.r, low.r, 0.97);
      image.data[place + 1] = part(high.g, low.g, 0.97);
      image.data[place + 2] = part(high.b, low.b, 0.98);
      image.data[place + 3] = 255;
    }
  }
  pen.putImageData(image, 0, 0);
  const texture = new CanvasTexture(canvas);
  texture.generateMipmaps = false;
  texture.minFilter = 1006;
  return texture;
}

function disc(): CanvasTexture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 128;
  const pen = canvas.getContext("2d")!;
  const fade = pen.createRadialGradient(64, 64, 0, 64, 64, 64);
  fade.addColorStop(0, "rgb(255 252 240)");
  fade.addColorStop(0.14, "rgb(255 250 232)");
  fade.addColorStop(0.17, "rgb(255 246 222 / 24%)");
  fade.addColorStop(0.3, "rgb(255 244 214 / 8%)");
  fade.addColorStop(0.55, "rgb(255 244 214 / 2%)");
  fade.addColorStop(1, "rgb(255 240 210 / 0%)");
  pen.fillStyle = fade;
  pen.fillRect(0, 0, 128, 128);
  return new CanvasTexture(canvas);
}
