// What drawings need of a canvas' context: that of a canvas, and the one that writes SVG (svg.ts), both have it.

export interface Pen {
  readonly canvas: { readonly width: number; readonly height: number };
  fillStyle: string | CanvasGradient | CanvasPattern;
  strokeStyle: string | CanvasGradient | CanvasPattern;
  globalAlpha: number;
  lineWidth: number;
  lineCap: CanvasLineCap;
  lineJoin: CanvasLineJoin;
  font: string;
  textAlign: CanvasTextAlign;
  textBaseline: CanvasTextBaseline;
  save(): void;
  restore(): void;
  translate(x: number, y: number): void;
  rotate(angle: number): void;
  scale(x: number, y: number): void;
  getTransform(): Pick<DOMMatrix, "a" | "e" | "f">;
  setLineDash(dash: number[]): void;
  beginPath(): void;
  moveTo(x: number, y: number): void;
  lineTo(x: number, y: number): void;
  rect(x: number, y: number, width: number, height: number): void;
  /** Whole circles only. */
  arc(x: number, y: number, radius: number, from: number, to: number): void;
  fill(): void;
  fill(shape: Shape): void;
  stroke(): void;
  stroke(shape: Shape): void;
  clip(): void;
  clip(shape: Shape, rule: CanvasFillRule): void;
  fillRect(x: number, y: number, width: number, height: number): void;
  strokeRect(x: number, y: number, width: number, height: number): void;
  isPointInPath(shape: Shape, x: number, y: number): boolean;
  fillText(text: string, x: number, y: number, room?: number): void;
  strokeText(text: string, x: number, y: number): void;
  measureText(text: string): { readonly width: number };
  drawImage(image: HTMLCanvasElement, x: number, y: number, width: number, height: number): void;
  /** Of a pen that has tiles of its own: what is filled with the tile, a square, that *draw* draws. */
  tiled?(side: number, draw: (pen: Pen) => void): string;
}

export type Ring = [number, number][];

/** Closed rings as a path that can be read again: a Path2D cannot. */
export class Shape extends Path2D {
  constructor(readonly rings: Ring[]) {
    super();
    for (const ring of rings) {
      this.moveTo(ring[0]![0], ring[0]![1]);
      for (let i = 1; i < ring.length; i++) this.lineTo(ring[i]![0], ring[i]![1]);
      this.closePath();
    }
  }
}
