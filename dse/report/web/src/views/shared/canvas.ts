// A canvas that is painted again when its box or the theme changes.
import { el } from "../../dom";
import { paintedBy, type Sheet } from "../../plot/sheet";
import type { Store } from "../../store";

export interface Painted {
  element: HTMLElement;
  canvas: HTMLCanvasElement;
  repaint: () => void;
}

/** A box of *kind* with a canvas in it, read out as *label*. */
export function createPainted(
  store: Store,
  kind: string,
  label: string,
  paint: (sheet: Sheet) => void,
  title: () => string = () => "",
): Painted {
  const canvas = el("canvas", { "aria-hidden": "true" });
  const element = el("div", { class: kind, role: "img", "aria-label": label }, canvas);
  const repaint = paintedBy(canvas, paint, { title });
  new ResizeObserver(repaint).observe(element);
  store.subscribe((_, changed) => {
    if (changed.has("theme") && element.isConnected) repaint();
  });
  return { element, canvas, repaint };
}
