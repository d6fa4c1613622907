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
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";

// Colours are those of the screen throughout: a conversion for each pixel is the dearest part of drawing it.
ColorManagement.enabled = false;

export const LIT = new MeshBasicMaterial({ vertexColors: true, side: DoubleSide });

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
