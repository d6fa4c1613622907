// One light for all that is solid: brightness is painted into the corners once, and night dims everything by one colour.
// Light that is computed for each pixel halves the frames without a graphics card.
import {
  BoxGeometry,
  type BufferGeometry,
  Color,
  ColorManagement,
  DoubleSide,
  Float32BufferAttribute,
  Matrix4,
  MeshBasicMaterial,
  ShaderChunk,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

// Colours are those of the screen throughout: a conversion for each pixel is the dearest part of drawing it.
ColorManagement.enabled = false;

// Fog takes exp(-a d), as air does; the one at hand is clear up close and a wall behind.
ShaderChunk.fog_fragment = ShaderChunk.fog_fragment.replace(
  "- fogDensity * fogDensity * vFogDepth * vFogDepth",
  "- fogDensity * vFogDepth",
);

export const LIT = new MeshBasicMaterial({ vertexColors: true, side: DoubleSide });

/** The host's headlamps: how bright (0 by day), and what turns places before the camera into those before the lamps. */
export const HEADLAMPS = { lit: { value: 0 }, from: { value: new Matrix4() } };

// Low beam: broader the farther, little above the lamps.
LIT.onBeforeCompile = (shader) => {
  Object.assign(shader.uniforms, { headlampsLit: HEADLAMPS.lit, headlampsFrom: HEADLAMPS.from });
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", "#include <common>\nuniform mat4 headlampsFrom;\nvarying vec3 vBefore;")
    .replace("#include <project_vertex>", "#include <project_vertex>\nvBefore = (headlampsFrom * mvPosition).xyz;");
  shader.fragmentShader = shader.fragmentShader
    .replace("#include <common>", "#include <common>\nuniform float headlampsLit;\nvarying vec3 vBefore;")
    .replace(
      "#include <color_fragment>",
      `#include <color_fragment>
      if (headlampsLit > 0.0) {
        float ahead = max(vBefore.x, 0.0);
        float side = vBefore.y / (1.2 + 0.2 * ahead);
        float above = max(vBefore.z - 0.4, 0.0);
        float beam = smoothstep(0.0, 5.0, ahead) * exp(-side * side - above) / (1.0 + ahead * ahead / 1600.0);
        diffuseColor.rgb += headlampsLit * beam * vColor * vec3(0.85, 0.82, 0.74);
      }`,
    );
};

const moved = new Matrix4();

/** *geometry* in one colour, put at a place, darker where it faces away from the sky. */
export function painted(geometry: BufferGeometry, colour: number, x = 0, y = 0, z = 0): BufferGeometry {
  const flat = geometry.index ? geometry.toNonIndexed() : geometry;
  flat.deleteAttribute("uv");
  flat.applyMatrix4(moved.makeTranslation(x, y, z));
  const normals = flat.getAttribute("normal");
  const base = new Color(colour);
  const colours: number[] = [];
  for (let i = 0; i < normals.count; i++) {
    const light = 0.76 + 0.24 * normals.getZ(i) + 0.08 * normals.getY(i) - 0.06 * normals.getX(i);
    colours.push(base.r * light, base.g * light, base.b * light);
  }
  flat.setAttribute("color", new Float32BufferAttribute(colours, 3));
  return flat;
}

/** A box around a place; what is above its middle is shorter by *taper* at both ends. */
export function box(
  [length, width, height]: [number, number, number],
  colour: number,
  [x, y, z]: [number, number, number],
  taper = 0,
): BufferGeometry {
  const geometry = new BoxGeometry(length, width, height).toNonIndexed();
  const points = geometry.getAttribute("position");
  for (let i = 0; i < points.count; i++) {
    if (points.getZ(i) > 0) points.setX(i, points.getX(i) - Math.sign(points.getX(i)) * taper);
  }
  if (taper) geometry.computeVertexNormals();
  return painted(geometry, colour, x, y, z);
}

export function joined(parts: BufferGeometry[]): BufferGeometry {
  return mergeGeometries(parts);
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
