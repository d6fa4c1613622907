// One hatch per requirement: told apart by direction first, by colour second.

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
  { size: 14, lines: [[0, 1, 0.5, 0.5], [0.5, 0, 1, 0.5]] },
  { size: 12, lines: [[0, 0.5, 1, 0.5], [0.5, 0, 0.5, 1]] },
];

export function hatch(pen: CanvasRenderingContext2D, index: number, colour: string): CanvasPattern {
  const ratio = window.devicePixelRatio || 1;
  const { size, lines } = STYLES[index % STYLES.length]!;
  const tile = document.createElement("canvas");
  const pixels = Math.round(size * ratio);
  tile.width = tile.height = pixels;
  const ink = tile.getContext("2d")!;
  ink.scale(pixels, pixels);
  ink.strokeStyle = colour;
  ink.lineWidth = 1.15 / size;
  ink.lineCap = "square";
  ink.beginPath();
  for (const [x0, y0, x1, y1] of lines) {
    // The neighbouring tiles' lines cross the corners of this one.
    for (const [dx, dy] of [[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]] as const) {
      ink.moveTo(x0 + dx, y0 + dy);
      ink.lineTo(x1 + dx, y1 + dy);
    }
  }
  ink.stroke();
  const pattern = pen.createPattern(tile, "repeat")!;
  pattern.setTransform(new DOMMatrix().scale(size / pixels));
  return pattern;
}

/** A small square in a requirement's hatch, for labels outside the plot. */
export function paintSwatch(canvas: HTMLCanvasElement, index: number, colour: string): void {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = canvas.height = Math.round(18 * ratio);
  const pen = canvas.getContext("2d")!;
  pen.scale(ratio, ratio);
  pen.fillStyle = hatch(pen, index, colour);
  pen.fillRect(0, 0, 18, 18);
  pen.strokeStyle = colour;
  pen.lineWidth = 2;
  pen.strokeRect(1, 1, 16, 16);
}
