// Signals beside the scene: a line over the whole run, where it is now, and its number.
import { el } from "../dom";
import type { Recording } from "./data";

const WIDTH = 260;
const HEIGHT = 62;

export interface Instruments {
  element: HTMLElement;
  show(time: number): void;
}

export function buildInstruments(recording: Recording, jump: (time: number) => void): Instruments {
  const parts = recording.document.instruments.map((_, number) => instrument(recording, number, jump));
  return {
    element: el("aside", { class: "instruments", "aria-label": "Signals" }, ...parts.map((part) => part.element)),
    show: (time) => {
      for (const part of parts) part.show(time);
    },
  };
}

function instrument(recording: Recording, number: number, jump: (time: number) => void): Instruments {
  const { title, unit, items, hasTarget } = recording.document.instruments[number]!;
  const name = `instrument.${number}`;
  const value = el("output", {});
  const heading = el("div", { class: "reading" }, el("span", { class: "name", title }, title), value);
  const text = (time: number): string => {
    if (items.length) return items[Math.round(recording.held(name, time))] ?? "";
    const now = recording.at(name, time);
    return Number.isFinite(now) ? `${now.toFixed(Math.abs(now) < 10 ? 2 : 1)} ${unit}` : "\u2013";
  };
  if (items.length) return { element: el("section", {}, heading), show: (time) => (value.textContent = text(time)) };
  const canvas = el("canvas", { width: 2 * WIDTH, height: 2 * HEIGHT, role: "img", "aria-label": `${title} over time` });
  canvas.addEventListener("pointerdown", (event) => {
    const box = canvas.getBoundingClientRect();
    jump(((event.clientX - box.left) / box.width) * recording.seconds);
  });
  const line = drawing(recording, name, hasTarget ? `target.${number}` : "");
  return {
    element: el("section", {}, heading, canvas),
    show: (time) => {
      value.textContent = text(time);
      line(canvas, time);
    },
  };
}

function drawing(recording: Recording, name: string, target: string): (canvas: HTMLCanvasElement, time: number) => void {
  const lines = [target, name].map((each) => recording.column(each)).filter((each) => each !== undefined);
  let [low, high] = [Infinity, -Infinity];
  for (const values of lines) for (const value of values) if (Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
  const span = high - low || 1;
  const whole = document.createElement("canvas");
  return (canvas, time) => {
    const [width, height] = [canvas.width, canvas.height];
    const style = getComputedStyle(canvas);
    const x = (share: number): number => share * (width - 4) + 2;
    const y = (value: number): number => height - 6 - ((value - low) / span) * (height - 12);
    if (whole.width !== width) {
      whole.width = width;
      whole.height = height;
      const pen = whole.getContext("2d")!;
      lines.forEach((values, number) => {
        const isTarget = target !== "" && number === 0;
        pen.strokeStyle = style.getPropertyValue(isTarget ? "--target" : "--current");
        pen.lineWidth = isTarget ? 2 : 3;
        pen.setLineDash(isTarget ? [8, 6] : []);
        pen.beginPath();
        values.forEach((value, i) => {
          if (Number.isFinite(value)) pen.lineTo(x(i / Math.max(values.length - 1, 1)), y(value));
        });
        pen.stroke();
      });
    }
    const pen = canvas.getContext("2d")!;
    pen.clearRect(0, 0, width, height);
    pen.drawImage(whole, 0, 0);
    pen.strokeStyle = style.getPropertyValue("--ink");
    pen.lineWidth = 2;
    pen.beginPath();
    const now = x(recording.seconds ? time / recording.seconds : 0);
    pen.moveTo(now, 0);
    pen.lineTo(now, height);
    pen.stroke();
  };
}
