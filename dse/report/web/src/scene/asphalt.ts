// What roads are made of: grains, wet where it rains, with the tracks of wheels in the snow.
import {
  DataTexture,
  DoubleSide,
  LinearFilter,
  LinearMipmapLinearFilter,
  MeshBasicMaterial,
  RedFormat,
  RepeatWrapping,
} from "three";
import { ALL_LIT, define, GRAIN, lit } from "./light";
import { hash, noise } from "./random";

const SIDE = 128;

// Rain fills the pores first, then puddles; a flat look mirrors the sky more.
const SURFACE = `
#ifdef GRAINS
  float grains = texture2D(grain, vFlat.xy * 0.31).r;
  shown *= 0.9 + 0.2 * grains;
#endif
  if (wetness > 0.0) {
    vec3 seen = normalize(cameraPosition - vFlat);
    float flatness = 1.0 - seen.z;
    float puddle = smoothstep(0.42, 0.62, texture2D(grain, vFlat.xy * 0.017).r);
    float mirror = wetness * (0.35 + 0.65 * puddle) * pow(flatness, 3.0);
    shown = mix(shown * (1.0 - 0.4 * wetness), horizon * diffuse, 0.75 * mirror);
  }`;

export const ROAD = lit(
  new MeshBasicMaterial({
    vertexColors: true,
    side: DoubleSide,
    polygonOffset: true,
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -2,
  }),
  SURFACE,
  "road",
);
ALL_LIT.push(ROAD);

/** With *grains* or *wet* the road is computed for each pixel; with neither it costs what everything else does. */
export function setSurface(grains: boolean, wet: boolean): void {
  define(ROAD, "GRAINS", grains);
  define(ROAD, "PLACED", grains || wet);
}

/** Made when the first stage is built: there is no texture without a page. */
export function buildGrain(): void {
  if (GRAIN.value) return;
  const data = new Uint8Array(SIDE * SIDE);
  const around = (x: number): number => ((x % SIDE) + SIDE) % SIDE;
  for (let y = 0; y < SIDE; y++) {
    for (let x = 0; x < SIDE; x++) {
      // The same at both ends, so that it goes on.
      const soft = (noise(x / 16, y / 16) * (SIDE - x) + noise((x - SIDE) / 16 + 64, y / 16) * x) / SIDE;
      data[y * SIDE + x] = 255 * (0.45 * hash(around(x), around(y)) + 0.55 * soft);
    }
  }
  const texture = new DataTexture(data, SIDE, SIDE, RedFormat);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.needsUpdate = true;
  GRAIN.value = texture;
}
