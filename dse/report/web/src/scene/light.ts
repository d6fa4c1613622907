// One light for all that is solid: sun, sky, what glossy surfaces mirror and the snow on top are computed for each corner,
// and night dims everything by one colour. Light that is computed for each pixel halves the frames without a graphics card.
import {
  BoxGeometry,
  type BufferGeometry,
  Color,
  ColorManagement,
  DoubleSide,
  Float32BufferAttribute,
  FrontSide,
  Matrix4,
  MeshBasicMaterial,
  ShaderChunk,
  type Texture,
  Vector3,
  type WebGLProgramParametersWithUniforms,
} from "three";
import { mergeGeometries, mergeVertices } from "three/addons/utils/BufferGeometryUtils.js";

// Colours are those of the screen throughout: a conversion for each pixel is the dearest part of drawing it.
ColorManagement.enabled = false;

// Fog takes exp(-a d), as air does; the one at hand is clear up close and a wall behind.
ShaderChunk.fog_fragment = ShaderChunk.fog_fragment.replace(
  "- fogDensity * fogDensity * vFogDepth * vFogDepth",
  "- fogDensity * vFogDepth",
);

/** What the weather does to light, set by sky.ts and read by every material here. */
export const AIR = {
  sunDirection: { value: new Vector3(0.4, -0.5, 0.77) },
  /** 1: clear, 0: the sun is behind clouds or below the horizon. */
  sunShare: { value: 1 },
  horizon: { value: new Color(0xd6e4f0) },
  zenith: { value: new Color(0x5b90d0) },
  snowCover: { value: 0 },
  wetness: { value: 0 },
};

/** The host's headlamps: how bright (0 by day), and what turns places before the camera into those before the lamps. */
export const HEADLAMPS = { lit: { value: 0 }, from: { value: new Matrix4() } };

/** Grey grains, set by asphalt.ts. */
export const GRAIN: { value: Texture | null } = { value: null };

const BEFORE = `#include <common>
attribute vec2 surface;
uniform mat4 headlampsFrom;
uniform vec3 sunDirection;
uniform float sunShare;
uniform float snowCover;
uniform vec3 horizon;
uniform vec3 zenith;
varying vec3 vBefore;
#ifdef PLACED
varying vec3 vFlat;
#endif`;

const PAINT = `vColor.xyz = color;
#ifdef USE_INSTANCING_COLOR
vColor.xyz *= mix(vec3(1.0), instanceColor.xyz, surface.x);
#endif`;

const SHADE = `#include <project_vertex>
vBefore = (headlampsFrom * mvPosition).xyz;
vec4 worldPlace = vec4(transformed, 1.0);
vec3 outward = normal;
#ifdef USE_INSTANCING
worldPlace = instanceMatrix * worldPlace;
outward = mat3(instanceMatrix) * outward;
#endif
worldPlace = modelMatrix * worldPlace;
outward = normalize(mat3(modelMatrix) * outward);
#ifdef PLACED
vFlat = worldPlace.xyz;
#endif
float laying = snowCover * smoothstep(0.5, 0.85, outward.z) * (1.0 - 0.75 * surface.y);
#ifndef USE_INSTANCING
laying *= 1.0 - surface.x; // driven away
#endif
vec3 albedo = mix(vColor.xyz, vec3(0.93, 0.95, 0.98), laying);
float facing = max(dot(outward, sunDirection), 0.0);
vec3 light = mix(vec3(0.80, 0.82, 0.86), vec3(0.60, 0.64, 0.72), sunShare) * (0.78 + 0.22 * outward.z);
light += sunShare * facing * vec3(0.62, 0.57, 0.47);
vColor.xyz = albedo * light;
if (surface.y > 0.0) {
  vec3 seen = normalize(cameraPosition - worldPlace.xyz);
  vec3 mirrored = reflect(-seen, outward);
  float share = surface.y * (0.1 + 0.9 * pow(1.0 - max(dot(outward, seen), 0.0), 4.0));
  vec3 above = mix(horizon, zenith, clamp(1.6 * mirrored.z, 0.0, 1.0));
  vec3 around = mirrored.z > 0.0 ? above : 0.45 * horizon;
  vColor.xyz = mix(vColor.xyz, around, share);
  vColor.xyz += sunShare * surface.y * pow(max(dot(mirrored, sunDirection), 0.0), 48.0);
}`;

const BEAM = `#include <color_fragment>
if (headlampsLit > 0.0) {
  float ahead = max(vBefore.x, 0.0);
  float side = vBefore.y / (1.2 + 0.2 * ahead);
  float above = max(vBefore.z - 0.4, 0.0);
  float beam = smoothstep(0.0, 5.0, ahead) * exp(-side * side - above) / (1.0 + ahead * ahead / 1600.0);
  diffuseColor.rgb += headlampsLit * beam * vColor * vec3(0.85, 0.82, 0.74);
}`;

/** Light for a material with colours and surfaces at its corners; *fragment* is put before the headlamps. */
export function lit(material: MeshBasicMaterial, fragment = "", name = "lit"): MeshBasicMaterial {
  material.customProgramCacheKey = () => name;
  material.onBeforeCompile = (shader: WebGLProgramParametersWithUniforms) => {
    Object.assign(shader.uniforms, AIR, { headlampsLit: HEADLAMPS.lit, headlampsFrom: HEADLAMPS.from, grain: GRAIN });
    // Only what has more to paint pays for its place.
    const placed = fragment ? "#define PLACED\n" : "";
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", placed + BEFORE)
      .replace("#include <color_vertex>", PAINT)
      .replace("#include <project_vertex>", SHADE);
    const own = "uniform float wetness;\nuniform vec3 horizon;\nuniform sampler2D grain;\nvarying vec3 vFlat;";
    const varying = `uniform float headlampsLit;\nvarying vec3 vBefore;\n${fragment ? own : ""}`;
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", `#include <common>\n${varying}`)
      .replace("#include <color_fragment>", `${BEAM}\n${fragment}`);
  };
  return material;
}

export const LIT = lit(new MeshBasicMaterial({ vertexColors: true, side: DoubleSide }));

/** Of closed bodies: what is inside is never seen. */
export const BODY = lit(new MeshBasicMaterial({ vertexColors: true, side: FrontSide }));

/** All of them go dark together. */
export const ALL_LIT: MeshBasicMaterial[] = [LIT, BODY];

const moved = new Matrix4();

/** What a surface is: share of the vehicle's own colour, and how much it mirrors. */
export type Surface = [paint: number, gloss: number];
export const MATT: Surface = [0, 0];

/** *geometry* in one colour, put at a place. */
export function painted(
  geometry: BufferGeometry,
  colour: number,
  x = 0,
  y = 0,
  z = 0,
  [paint, gloss]: Surface = MATT,
): BufferGeometry {
  const flat = geometry.index ? geometry.toNonIndexed() : geometry;
  flat.deleteAttribute("uv");
  flat.applyMatrix4(moved.makeTranslation(x, y, z));
  const { count } = flat.getAttribute("position");
  const { r, g, b } = new Color(colour);
  const colours = new Float32Array(3 * count);
  const surfaces = new Float32Array(2 * count);
  for (let i = 0; i < count; i++) {
    colours.set([r, g, b], 3 * i);
    surfaces.set([paint, gloss], 2 * i);
  }
  flat.setAttribute("color", new Float32BufferAttribute(colours, 3));
  flat.setAttribute("surface", new Float32BufferAttribute(surfaces, 2));
  return flat;
}

/** A box around a place; what is above its middle is shorter by *taper* at both ends. */
export function box(
  [length, width, height]: [number, number, number],
  colour: number,
  [x, y, z]: [number, number, number],
  taper = 0,
  surface: Surface = MATT,
): BufferGeometry {
  const geometry = new BoxGeometry(length, width, height).toNonIndexed();
  const points = geometry.getAttribute("position");
  for (let i = 0; i < points.count; i++) {
    if (points.getZ(i) > 0) points.setX(i, points.getX(i) - Math.sign(points.getX(i)) * taper);
  }
  if (taper) geometry.computeVertexNormals();
  return painted(geometry, colour, x, y, z, surface);
}

export function joined(parts: BufferGeometry[]): BufferGeometry {
  return mergeGeometries(parts);
}

/** The same with each corner once: programs in place of a card compute it once, too. */
export function indexed(geometry: BufferGeometry): BufferGeometry {
  const merged = mergeVertices(geometry, 1e-5);
  geometry.dispose();
  return merged;
}

/** Whether a program draws in place of a graphics card. */
export function isDrawnByProgram(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const told = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|basic render|software/i.test(name);
}
