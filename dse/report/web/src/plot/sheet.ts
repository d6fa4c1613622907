// What is painted on: a canvas of the page, or a part of a picture that is saved.
import { el } from "../dom";
import { palette } from "../theme";
import { fitted } from "./frame";
import { type Entry, paintLegend } from "./legend";
import type { Pen } from "./pen";
import { createSvg } from "./svg";

/** Drawing units are CSS pixels. */
export interface Sheet {
  pen: Pen;
  width: number;
  height: number;
}

/** A part of a picture that is saved. */
export interface Part extends Pick<Sheet, "width" | "height"> {
  title: string;
  paint: (sheet: Sheet) => void;
  legend?: Entry[];
}

const HEAD = 30;
const RATIO = 2;
const GAP = 12;

interface Painter {
  paint: (sheet: Sheet) => void;
  title: () => string;
  legend: () => Entry[];
}

const painters = new WeakMap<Element, Painter>();

/** Has *paint* paint *canvas*, now and then and when it is saved, then with a title and a legend; gives back what paints it. */
export function paintedBy(
  canvas: HTMLCanvasElement,
  paint: (sheet: Sheet) => void,
  { title = () => "", legend = () => [] }: Partial<Painter> = {},
): () => void {
  painters.set(canvas, { paint, title, legend });
  return () => {
    if (canvas.clientWidth && canvas.clientHeight) paint(fit(canvas));
  };
}

/** What is painted in *box*, as it is shown; canvases of the same parent lie over each other. */
export function partsIn(box: Element): Part[] {
  const layered = new Map<Element, Painter[]>();
  const parts: Part[] = [];
  for (const canvas of box.querySelectorAll("canvas")) {
    const painter = painters.get(canvas);
    if (!painter) continue;
    const layers = layered.get(canvas.parentElement!);
    if (layers) {
      layers.push(painter);
      continue;
    }
    const all = [painter];
    layered.set(canvas.parentElement!, all);
    const { clientWidth: width, clientHeight: height } = canvas;
    parts.push({
      title: painter.title(),
      width,
      height,
      legend: painter.legend(),
      paint: (sheet) => all.forEach(({ paint }) => paint(sheet)),
    });
  }
  return parts;
}

/** A canvas sized to its box in device pixels. */
export function fit(canvas: HTMLCanvasElement): { pen: CanvasRenderingContext2D; width: number; height: number } {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d")!;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

/** Parts beside and below each other in *room*, each under its title, in the colours of the page. */
export function pngOf(parts: Part[], room: number): Promise<Blob> {
  const { width, height, places } = laidOut(parts, room);
  const canvas = el("canvas");
  canvas.width = width * RATIO;
  canvas.height = height * RATIO;
  const pen = canvas.getContext("2d")!;
  pen.scale(RATIO, RATIO);
  compose({ pen, width, height }, places);
  return new Promise((done, failed) =>
    canvas.toBlob((blob) => (blob ? done(blob) : failed(new Error("the picture is too large for this browser")))),
  );
}

/** The same as SVG. */
export function svgOf(parts: Part[], room: number): Blob {
  const { width, height, places } = laidOut(parts, room);
  const { pen, text } = createSvg(
    width,
    height,
    parts
      .map(({ title }) => title)
      .filter(Boolean)
      .join(", "),
  );
  compose({ pen, width, height }, places);
  return new Blob([text()], { type: "image/svg+xml" });
}

interface Place {
  part: Part;
  x: number;
  y: number;
}

function laidOut(parts: Part[], room: number): { width: number; height: number; places: Place[] } {
  const scratch = el("canvas").getContext("2d")!;
  const colours = palette();
  const heightOf = (part: Part): number =>
    (part.title ? HEAD : 0) + part.height + paintLegend(scratch, part.legend ?? [], part.width, colours);
  let [x, y, row, width] = [0, 0, 0, 0];
  const places = parts.map((part) => {
    if (x && x + part.width > room) [x, y, row] = [0, y + row + GAP, 0];
    const place = { part, x, y };
    width = Math.max(width, x + part.width);
    row = Math.max(row, heightOf(part));
    x += part.width + GAP;
    return place;
  });
  return { width: Math.ceil(width), height: Math.ceil(y + row), places };
}

function compose({ pen, width, height }: Sheet, places: Place[]): void {
  const colours = palette();
  pen.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--card").trim();
  pen.fillRect(0, 0, width, height);
  for (const { part, x, y } of places) {
    pen.save();
    pen.translate(x, y);
    if (part.title) {
      pen.fillStyle = colours.ink;
      pen.font = `600 14px ${colours.font}`;
      pen.textAlign = "left";
      pen.textBaseline = "alphabetic";
      pen.fillText(fitted(pen, part.title, part.width - 16), 8, 20);
      pen.translate(0, HEAD);
    }
    pen.save();
    part.paint({ pen, width: part.width, height: part.height });
    pen.restore();
    pen.translate(0, part.height);
    paintLegend(pen, part.legend ?? [], part.width, colours);
    pen.restore();
  }
}
