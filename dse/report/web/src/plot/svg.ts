// A pen that writes SVG: what draws on a canvas draws on it, too.
import type { Pen, Ring, Shape } from "./pen";

/** Pixels of a unit, for what is pixels all the same. */
const DEVICE = 2;
const START = {
  fillStyle: "#000",
  strokeStyle: "#000",
  globalAlpha: 1,
  lineWidth: 1,
  lineCap: "butt",
  lineJoin: "miter",
  font: "10px sans-serif",
  textAlign: "start",
  textBaseline: "alphabetic",
} as const;
const STYLE = Object.keys(START) as (keyof typeof START)[];

interface Hidden {
  matrix: DOMMatrix;
  dash: number[];
  /** The id of what is clipped to, "" for nothing. */
  clip: string;
}

/** The pen, and the document as it has drawn it so far. */
export function createSvg(width: number, height: number, title: string): { pen: Pen; text: () => string } {
  const definitions: string[] = [];
  const { pen, drawn } = createPen(width, height, definitions);
  const label = title ? `<title>${escaped(title)}</title>` : "";
  const size = `width="${round(width)}" height="${round(height)}" viewBox="0 0 ${round(width)} ${round(height)}"`;
  return {
    pen,
    text: () =>
      `<svg xmlns="http://www.w3.org/2000/svg" ${size}>${label}<defs>${definitions.join("")}</defs>${drawn()}</svg>\n`,
  };
}

// Definitions are shared by the pens of one document, so that no two have the same id.
function createPen(width: number, height: number, definitions: string[]): { pen: Pen; drawn: () => string } {
  const scratch = document.createElement("canvas").getContext("2d")!;
  const body: string[] = [];
  const stack: [Partial<Pen>, Hidden][] = [];
  let hidden: Hidden = { matrix: new DOMMatrix(), dash: [], clip: "" };
  let group = "";
  let path = "";

  const put = (element: string): void => {
    if (group !== hidden.clip) {
      if (group) body.push("</g>");
      if (hidden.clip) body.push(`<g clip-path="url(#${hidden.clip})">`);
      group = hidden.clip;
    }
    body.push(element);
  };
  const define = (element: (id: string) => string): string => {
    const id = `d${definitions.length}`;
    definitions.push(element(id));
    return id;
  };
  const place = (x: number, y: number): string => {
    const { a, b, c, d, e, f } = hidden.matrix;
    return `${round(a * x + c * y + e)} ${round(b * x + d * y + f)}`;
  };
  // As on a canvas, what has no place is left out.
  const add = (step: string, ...points: [number, number][]): void => {
    if (points.flat().every(Number.isFinite))
      path += points.map(([x, y], index) => (index ? "L" : step) + place(x, y)).join("");
  };
  const box = (x: number, y: number, w: number, h: number): string => {
    const before = path;
    path = "";
    pen.rect(x, y, w, h);
    const drawn = path;
    path = before;
    return drawn;
  };
  const ringsOf = (rings: Ring[]): string =>
    rings.map((ring) => `M${ring.map(([x, y]) => place(x, y)).join("L")}Z`).join("");
  const paint = (kind: "fill" | "stroke", style: Pen["fillStyle"]): string => {
    const colour = String(style);
    if (colour.startsWith("url(")) return `${kind}="${colour}"${opacity(kind, pen.globalAlpha)}`;
    const [opaque, alpha] = plain(scratch, colour);
    return `${kind}="${opaque}"${opacity(kind, alpha * pen.globalAlpha)}`;
  };
  const line = (): string => {
    const factor = Math.hypot(hidden.matrix.a, hidden.matrix.b);
    const dash = hidden.dash.length
      ? ` stroke-dasharray="${hidden.dash.map((each) => round(each * factor)).join(" ")}"`
      : "";
    const ends =
      (pen.lineCap === "butt" ? "" : ` stroke-linecap="${pen.lineCap}"`) +
      (pen.lineJoin === "miter" ? "" : ` stroke-linejoin="${pen.lineJoin}"`);
    return `fill="none" ${paint("stroke", pen.strokeStyle)} stroke-width="${round(pen.lineWidth * factor)}"${ends}${dash}`;
  };
  const outline = (shape: Shape | undefined): string => (shape ? ringsOf(shape.rings) : path);
  const write = (text: string, x: number, y: number, how: string, room = Infinity): void => {
    const { style, weight, size, family } = fontOf(scratch, pen.font);
    const { a, b, c, d, e, f } = hidden.matrix.translate(x, y + below(scratch, pen.textBaseline));
    const anchor = { center: "middle", right: "end", end: "end", left: "start", start: "start" }[pen.textAlign];
    const fitted =
      pen.measureText(text).width > room ? ` textLength="${round(room)}" lengthAdjust="spacingAndGlyphs"` : "";
    const font = `font-family="${escaped(family)}" font-size="${size}"${weight === "400" ? "" : ` font-weight="${weight}"`}${style === "normal" ? "" : ` font-style="${style}"`}`;
    put(
      `<text transform="matrix(${[a, b, c, d].map((each) => Number(each.toFixed(5))).join(" ")} ${round(e)} ${round(f)})" text-anchor="${anchor}" ${font} ${how}${fitted}>${escaped(text)}</text>`,
    );
  };

  const pen: Pen = {
    ...START,
    canvas: { width: Math.round(width * DEVICE), height: Math.round(height * DEVICE) },
    save() {
      stack.push([Object.fromEntries(STYLE.map((key) => [key, pen[key]])), hidden]);
    },
    restore() {
      const last = stack.pop();
      if (!last) return;
      Object.assign(pen, last[0]);
      hidden = last[1];
    },
    translate(x, y) {
      hidden = { ...hidden, matrix: hidden.matrix.translate(x, y) };
    },
    rotate(angle) {
      hidden = { ...hidden, matrix: hidden.matrix.rotate((angle * 180) / Math.PI) };
    },
    scale(x, y) {
      hidden = { ...hidden, matrix: hidden.matrix.scale(x, y) };
    },
    getTransform: () => ({ a: hidden.matrix.a * DEVICE, e: hidden.matrix.e * DEVICE, f: hidden.matrix.f * DEVICE }),
    setLineDash(dash) {
      hidden = { ...hidden, dash };
    },
    beginPath() {
      path = "";
    },
    moveTo(x, y) {
      add("M", [x, y]);
    },
    lineTo(x, y) {
      add(path ? "L" : "M", [x, y]);
    },
    rect(x, y, w, h) {
      const before = path;
      add("M", [x, y], [x + w, y], [x + w, y + h], [x, y + h]);
      if (path !== before) path += "Z";
    },
    arc(x, y, radius) {
      if (![x, y, radius].every(Number.isFinite)) return;
      const r = round(radius * Math.hypot(hidden.matrix.a, hidden.matrix.b));
      const half = `A${r} ${r} 0 1 1 `;
      const start = `M${place(x + radius, y)}`;
      path += `${path.endsWith(start) ? "" : start}${half}${place(x - radius, y)}${half}${place(x + radius, y)}`;
    },
    fill(shape?: Shape) {
      const d = outline(shape);
      if (d) put(`<path d="${d}" ${paint("fill", pen.fillStyle)}/>`);
    },
    stroke(shape?: Shape) {
      const d = outline(shape);
      if (d) put(`<path d="${d}" ${line()}/>`);
    },
    clip(shape?: Shape, rule: CanvasFillRule = "nonzero") {
      const inner = hidden.clip ? ` clip-path="url(#${hidden.clip})"` : "";
      const d = outline(shape);
      hidden = {
        ...hidden,
        clip: define((id) => `<clipPath id="${id}"${inner}><path d="${d}" clip-rule="${rule}"/></clipPath>`),
      };
    },
    fillRect(x, y, w, h) {
      const d = box(x, y, w, h);
      if (d) put(`<path d="${d}" ${paint("fill", pen.fillStyle)}/>`);
    },
    strokeRect(x, y, w, h) {
      const d = box(x, y, w, h);
      if (d) put(`<path d="${d}" ${line()}/>`);
    },
    isPointInPath(shape, x, y) {
      const at = hidden.matrix.inverse().transformPoint({ x: x / DEVICE, y: y / DEVICE });
      return scratch.isPointInPath(shape, at.x, at.y);
    },
    fillText(text, x, y, room) {
      write(text, x, y, paint("fill", pen.fillStyle), room);
    },
    strokeText(text, x, y) {
      write(text, x, y, line());
    },
    measureText(text) {
      scratch.font = pen.font;
      return scratch.measureText(text);
    },
    drawImage(image, x, y, w, h) {
      const { a, d } = hidden.matrix;
      const [left, top] = place(x, y).split(" ");
      put(
        `<image x="${left}" y="${top}" width="${round(a * w)}" height="${round(d * h)}" href="${image.toDataURL()}" image-rendering="pixelated"/>`,
      );
    },
    tiled(side, draw) {
      const tile = createPen(side, side, definitions);
      draw(tile.pen);
      const drawn = tile.drawn();
      return `url(#${define((id) => `<pattern id="${id}" width="${round(side)}" height="${round(side)}" patternUnits="userSpaceOnUse">${drawn}</pattern>`)})`;
    },
  };
  return { pen, drawn: () => body.join("") + (group ? "</g>" : "") };
}

function opacity(kind: "fill" | "stroke", alpha: number): string {
  return alpha < 1 ? ` ${kind}-opacity="${Number(alpha.toFixed(3))}"` : "";
}

/** A colour as #rrggbb, which every program reads, and its opacity. */
function plain(scratch: CanvasRenderingContext2D, colour: string): [string, number] {
  scratch.fillStyle = colour;
  const read = String(scratch.fillStyle);
  if (read.startsWith("#")) return [read, 1];
  const [red, green, blue, alpha] = read.match(/[\d.]+/g)!.map(Number) as [number, number, number, number];
  return [`#${[red, green, blue].map((each) => each.toString(16).padStart(2, "0")).join("")}`, alpha];
}

function fontOf(
  scratch: CanvasRenderingContext2D,
  font: string,
): { style: string; weight: string; size: number; family: string } {
  scratch.font = font;
  const [, before, size, family] = /^(.*?)\s*([\d.]+)px\s+(.*)$/.exec(scratch.font)!;
  const weight = /\b(bold|\d{3})\b/.exec(before!)?.[1] ?? "400";
  return { style: before!.includes("italic") ? "italic" : "normal", weight, size: Number(size), family: family! };
}

// How far a text's line lies below the place it is put at; programs do not agree on baselines.
function below(scratch: CanvasRenderingContext2D, baseline: CanvasTextBaseline): number {
  const ascent = (of: CanvasTextBaseline): number => {
    scratch.textBaseline = of;
    return scratch.measureText("x").actualBoundingBoxAscent;
  };
  return ascent("alphabetic") - ascent(baseline);
}

function round(value: number): string {
  return String(Math.round(value * 100) / 100);
}

// Halves of letters, and signs that no XML may have, are left out.
function escaped(text: string): string {
  return (
    text
      // biome-ignore lint/suspicious/noControlCharactersInRegex: these are what is left out
      .replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f\ufffe\uffff]|\p{Cs}/gu, "")
      .replace(/[&<>"]/g, (sign) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[sign]!)
  );
}
