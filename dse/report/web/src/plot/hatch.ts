// One hatch per requirement: told apart by direction first, by colour second.
import type { Pen } from "./pen";

interface Style {
  size: number;
  lines: [number, number, number, number][];
}

// Lines run from edge to edge of a square tile, so that tiles join without a seam.
const STYLES: Style[] = [
  { size: 10, lines: [[0, 1, 1, 0]] },
  { size: 10, lines: [[0, 0, 1, 1]] },
  { size: 8, lines: [[0, 0.5, 1, 0.5]] },
  { size: 8, lines: [[0.5, 0, 0.5, 1]] },
  {
    size: 14,
    lines: [
      [0, 1, 0.5, 0.5],
      [0.5, 0, 1, 0.5],
    ],
  },
  {
    size: 12,
    lines: [
      [0, 0.5, 1, 0.5],
      [0.5, 0, 0.5, 1],
    ],
  },
];

export function hatch(pen: Pen, index: number, colour: string): string | CanvasPattern {
  const { size } = STYLES[index % STYLES.length]!;
  if (pen.tiled) return pen.tiled(size, (ink) => drawTile(ink, index, colour));
  const ratio = window.devicePixelRatio || 1;
  const tile = document.createElement("canvas");
  const pixels = Math.round(size * ratio);
  tile.width = tile.height = pixels;
  const ink = tile.getContext("2d")!;
  ink.scale(pixels / size, pixels / size);
  drawTile(ink, index, colour);
  const pattern = ink.createPattern(tile, "repeat")!;
  pattern.setTransform(new DOMMatrix().scale(size / pixels));
  return pattern;
}

function drawTile(ink: Pen, index: number, colour: string): void {
  const { size, lines } = STYLES[index % STYLES.length]!;
  ink.strokeStyle = colour;
  ink.lineWidth = 1.15;
  ink.lineCap = "square";
  ink.beginPath();
  for (const [x0, y0, x1, y1] of lines) {
    // The neighbouring tiles' lines cross the corners of this one.
    for (const [dx, dy] of [
      [0, 0],
      [1, 0],
      [-1, 0],
      [0, 1],
      [0, -1],
    ] as const) {
      ink.moveTo((x0 + dx) * size, (y0 + dy) * size);
      ink.lineTo((x1 + dx) * size, (y1 + dy) * size);
    }
  }
  ink.stroke();
}

/** A small square in a requirement's hatch, for labels outside the plot. */
export function paintSwatch(canvas: HTMLCanvasElement, index: number, colour: string): void {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = canvas.height = Math.round(18 * ratio);
  const pen = canvas.getContext("2d")!;
  pen.scale(ratio, ratio);
  drawSwatch(pen, 18, index, colour);
}

/** The square, *side* wide, below and right of where the pen is. */
export function drawSwatch(pen: Pen, side: number, index: number, colour: string): void {
  pen.fillStyle = hatch(pen, index, colour);
  pen.fillRect(0, 0, side, side);
  pen.strokeStyle = colour;
  pen.lineWidth = 2;
  pen.strokeRect(1, 1, side - 2, side - 2);
}
