// Signals beside the scene: a line over all of the run there is, where it is now, and its number.
import { el } from "../dom";
import type { Source } from "./data";

const WIDTH = 260;
const HEIGHT = 62;
const REDRAWN = 100; // ms

export interface Instruments {
  element: HTMLElement;
  show(time: number): void;
}

export function buildInstruments(source: Source, jump?: (time: number) => void): Instruments {
  const parts = source.document.instruments.map((_, number) => instrument(source, number, jump));
  return {
    element: el("aside", { class: "instruments", "aria-label": "Signals" }, ...parts.map((part) => part.element)),
    show: (time) => {
      for (const part of parts) part.show(time);
    },
  };
}

function instrument(source: Source, number: number, jump?: (time: number) => void): Instruments {
  const { title, unit, items, hasTarget } = source.document.instruments[number]!;
  const name = `instrument.${number}`;
  const value = el("output", {});
  const heading = el("div", { class: "reading" }, el("span", { class: "name", title }, title), value);
  const text = (time: number): string => {
    if (items.length) return items[Math.round(source.held(name, time))] ?? "";
    const now = source.at(name, time);
    return Number.isFinite(now) ? `${now.toFixed(Math.abs(now) < 10 ? 2 : 1)} ${unit}` : "\u2013";
  };
  if (items.length) return { element: el("section", {}, heading), show: (time) => (value.textContent = text(time)) };
  const canvas = el("canvas", {
    width: 2 * WIDTH,
    height: 2 * HEIGHT,
    role: "img",
    "aria-label": `${title} over time`,
  });
  if (jump) {
    canvas.addEventListener("pointerdown", (event) => {
      const box = canvas.getBoundingClientRect();
      const [from, to] = source.span();
      jump(from + ((event.clientX - box.left) / box.width) * (to - from));
    });
  }
  const line = drawing(source, name, hasTarget ? `target.${number}` : "");
  return {
    element: el("section", {}, heading, canvas),
    show: (time) => {
      value.textContent = text(time);
      line(canvas, time);
    },
  };
}

function drawing(source: Source, name: string, target: string): (canvas: HTMLCanvasElement, time: number) => void {
  const whole = document.createElement("canvas");
  let version = -1;
  let drawn = -Infinity;
  return (canvas, time) => {
    const [width, height] = [canvas.width, canvas.height];
    const [from, to] = source.span();
    const style = getComputedStyle(canvas);
    const x = (moment: number): number => ((moment - from) / (to - from || 1)) * (width - 4) + 2;
    const now = performance.now();
    // What still grows is drawn again, but not sixty times a second.
    if (source.version !== version && now - drawn > REDRAWN) {
      [version, drawn] = [source.version, now];
      whole.width = width;
      whole.height = height;
      lines(whole.getContext("2d")!, source, style, name, target, x, height);
    }
    const pen = canvas.getContext("2d")!;
    pen.clearRect(0, 0, width, height);
    pen.drawImage(whole, 0, 0);
    pen.strokeStyle = style.getPropertyValue("--ink");
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(x(time), 0);
    pen.lineTo(x(time), height);
    pen.stroke();
  };
}

function lines(
  pen: CanvasRenderingContext2D,
  source: Source,
  style: CSSStyleDeclaration,
  name: string,
  target: string,
  x: (time: number) => number,
  height: number,
): void {
  const [from] = source.span();
  let [low, high] = [Infinity, -Infinity];
  for (const each of [target, name]) {
    source.each(each, (time, value) => {
      if (time >= from && Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
    });
  }
  for (const each of [target, name]) {
    const isTarget = each === target;
    pen.strokeStyle = style.getPropertyValue(isTarget ? "--target" : "--current");
    pen.lineWidth = isTarget ? 2 : 3;
    pen.setLineDash(isTarget ? [8, 6] : []);
    pen.beginPath();
    source.each(each, (time, value) => {
      if (time >= from && Number.isFinite(value))
        pen.lineTo(x(time), height - 6 - ((value - low) / (high - low || 1)) * (height - 12));
    });
    pen.stroke();
  }
}
