// One light for all that is solid: sun, sky, fog, what glossy surfaces mirror and the snow on top are computed for each
// corner, and night dims everything by one colour. Without a graphics card what is computed for each pixel is the dearest:
// that are only the grains of the road, water on it, headlamps by night, and fog where it is dense.
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

const CORNER = `#include <common>
attribute vec2 surface;
uniform vec3 diffuse;
uniform vec3 fogColor;
uniform float fogDensity;
uniform vec3 sunDirection;
uniform float sunShare;
uniform float snowCover;
uniform vec3 horizon;
uniform vec3 zenith;
varying vec3 vShade;
#ifdef FINE
uniform mat4 headlampsFrom;
uniform float headlampsLit;
varying vec3 vBefore;
varying float vDepth;
#endif
#ifdef PLACED
varying vec3 vFlat;
varying float vFog;
#endif
void main() {
  vec3 paint = color;
  vec4 place = vec4(position, 1.0);
  vec3 outward = normal;
#ifdef USE_INSTANCING_COLOR
  if (surface.x <= 1.0) paint *= mix(vec3(1.0), instanceColor.xyz, surface.x);
#endif
#ifdef USE_INSTANCING
  place = instanceMatrix * place;
  outward = mat3(instanceMatrix) * outward;
#endif
  place = modelMatrix * place;
  outward = normalize(mat3(modelMatrix) * outward);
  vec4 before = viewMatrix * place;
  gl_Position = projectionMatrix * before;
  if (snowCover > 0.0) {
    float laying = snowCover * smoothstep(0.5, 0.85, outward.z) * (1.0 - 0.75 * surface.y);
#ifndef USE_INSTANCING
    laying *= 1.0 - surface.x; // driven away
#endif
    paint = mix(paint, vec3(0.93, 0.95, 0.98), laying);
  }
  float facing = max(dot(outward, sunDirection), 0.0);
  vec3 light = mix(vec3(0.80, 0.82, 0.86), vec3(0.60, 0.64, 0.72), sunShare) * (0.78 + 0.22 * outward.z);
  vShade = paint * (light + sunShare * facing * vec3(0.62, 0.57, 0.47));
  if (surface.y > 0.0) {
    vec3 seen = normalize(cameraPosition - place.xyz);
    vec3 mirrored = reflect(-seen, outward);
    float share = surface.y * (0.1 + 0.9 * pow(1.0 - max(dot(outward, seen), 0.0), 4.0));
    vec3 above = mix(horizon, zenith, clamp(1.6 * mirrored.z, 0.0, 1.0));
    vShade = mix(vShade, mirrored.z > 0.0 ? above : 0.45 * horizon, share);
    vShade += sunShare * surface.y * pow(max(dot(mirrored, sunDirection), 0.0), 48.0);
  }
#ifdef PLACED
  vFlat = place.xyz;
#endif
#ifdef FINE
  // Night dims everything but what shines by itself.
  if (surface.x > 1.0) vShade = mix(vShade, vec3(0.98, 0.82, 0.5) / diffuse, headlampsLit);
  vBefore = (headlampsFrom * before).xyz;
  vDepth = -before.z;
#else
  float fog = 1.0 - exp(fogDensity * before.z);
#ifdef PLACED
  vShade *= diffuse;
  vFog = fog;
#else
  vShade = mix(vShade * diffuse, fogColor, fog);
#endif
#endif
}`;

const pixel = (fragment: string): string => `#include <common>
uniform vec3 diffuse;
uniform vec3 fogColor;
uniform float fogDensity;
varying vec3 vShade;
#ifdef FINE
uniform float headlampsLit;
varying vec3 vBefore;
varying float vDepth;
#endif
#ifdef PLACED
uniform float wetness;
uniform vec3 horizon;
uniform sampler2D grain;
varying vec3 vFlat;
varying float vFog;
#endif
void main() {
  vec3 shown = vShade;
#ifdef FINE
  shown *= diffuse;
  float wide = 1.2 + 0.2 * vBefore.x;
  if (headlampsLit > 0.0 && vBefore.x > 0.0 && vBefore.x < 250.0 && abs(vBefore.y) < 2.5 * wide) {
    float side = vBefore.y / wide;
    float above = max(vBefore.z - 0.4, 0.0);
    float beam = smoothstep(0.0, 5.0, vBefore.x) * exp(-side * side - above) / (1.0 + vBefore.x * vBefore.x / 1600.0);
    shown += headlampsLit * beam * vShade * vec3(0.85, 0.82, 0.74);
  }
#endif
#ifdef PLACED
${fragment}
#endif
#ifdef FINE
  shown = mix(shown, fogColor, 1.0 - exp(-fogDensity * vDepth));
#elif defined(PLACED)
  shown = mix(shown, fogColor, vFog);
#endif
  gl_FragColor = vec4(shown, 1.0);
}`;

/** Light for a material with colours and surfaces at its corners; *fragment* changes `shown` where PLACED is defined. */
export function lit(material: MeshBasicMaterial, fragment = "", name = "lit"): MeshBasicMaterial {
  material.customProgramCacheKey = () => name;
  material.onBeforeCompile = (shader: WebGLProgramParametersWithUniforms) => {
    Object.assign(shader.uniforms, AIR, { headlampsLit: HEADLAMPS.lit, headlampsFrom: HEADLAMPS.from, grain: GRAIN });
    shader.vertexShader = CORNER;
    shader.fragmentShader = pixel(fragment);
  };
  return material;
}

/** Defines *name* in the programs of *material*, or not; those that were used before are kept. */
export function define(material: MeshBasicMaterial, name: string, isDefined: boolean): void {
  const own: MeshBasicMaterial & { defines?: Record<string, string> } = material;
  const { [name]: was, ...others } = own.defines ?? {};
  if ((was !== undefined) === isDefined) return;
  own.defines = isDefined ? { ...others, [name]: "" } : others;
  own.needsUpdate = true;
}

/** With *fine* light, lamps and fog are computed for each pixel; else fog is, as all other light, for each corner. */
export function setLight(fine: boolean): void {
  for (const each of ALL_LIT) define(each, "FINE", fine);
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
/** In place of the share of paint: what is lit from within by night. */
export const LAMPLIT = 2;

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
