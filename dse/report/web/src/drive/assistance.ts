// What driver assistance sees, as such displays show it: the own lane, the vehicle ahead with its distance, the speed limit.
import { el } from "../dom";
import type { Stream } from "../scene/stream";

const WIDE = 150;
const TALL = 96;
const FAR = 100; // m at the top of the lane

export interface Assistance {
  element: HTMLElement;
  show(time: number): void;
}

export function buildAssistance(stream: Stream): Assistance {
  const canvas = el("canvas", {
    width: 2 * WIDE,
    height: 2 * TALL,
    role: "img",
    "aria-label": "Lane and vehicle ahead",
  });
  const limit = el("output", { class: "limit", "aria-label": "Speed limit in km/h" });
  const words = el("span", { class: "ahead" });
  const element = el("div", { class: "assistance" }, canvas, limit, words);
  // A bench without such a signal has no such display.
  const knows = (name: string): boolean => stream.has(`driver.${name}`);
  const pen = canvas.getContext("2d")!;
  return {
    element,
    show: (time) => {
      const at = (name: string): number => stream.held(`driver.${name}`, time);
      const allowed = knows("limit") ? at("limit") * 3.6 : 0;
      limit.hidden = !(allowed > 0.5);
      limit.textContent = allowed.toFixed(0);
      const speed = stream.at("host.speed", time);
      limit.classList.toggle("over", allowed > 0.5 && speed * 3.6 > allowed + 3);
      const isSeen = knows("gap") && at("detected") > 0.5 && Number.isFinite(at("gap"));
      const gap = isSeen ? at("gap") : NaN;
      words.textContent = isSeen ? `vehicle ahead ${gap.toFixed(0)} m` : "no vehicle ahead";
      const width = knows("width") && at("width") > 1 ? at("width") : 3.5;
      draw(pen, knows("offset") ? at("offset") : 0, width, gap, speed);
    },
  };
}

/** The road as it is seen from above the car: the car at the bottom stays, the lane moves under it. */
function draw(pen: CanvasRenderingContext2D, offset: number, width: number, gap: number, speed: number): void {
  pen.setTransform(2, 0, 0, 2, 0, 0);
  pen.clearRect(0, 0, WIDE, TALL);
  const y = (ahead: number): number =>
    TALL - 22 - (TALL - 30) * (1 - 1 / (1 + (2.2 * Math.max(ahead, 0)) / FAR)) * 1.45;
  const scale = (ahead: number): number => 15 / (1 + (4 * Math.max(ahead, 0)) / FAR);
  const x = (left: number, ahead: number): number => WIDE / 2 - left * scale(ahead);
  const isNear = Math.abs(offset) > width / 2 - 1.05;
  for (const side of [1, -1]) {
    const border = (side * width) / 2 - offset;
    const isCrossed = isNear && Math.sign(border) === side && Math.sign(offset) === side;
    pen.strokeStyle = isCrossed ? "#ff6f66" : "#9fc2ff";
    pen.lineWidth = isCrossed ? 3 : 2;
    pen.beginPath();
    for (let ahead = -6; ahead <= FAR; ahead += 4) pen.lineTo(x(border, ahead), y(ahead) + (ahead < 0 ? 14 : 0));
    pen.stroke();
  }
  if (Number.isFinite(gap)) {
    const isClose = gap < 0.9 * speed;
    car(pen, x(0, gap), y(gap), 1.9 * scale(gap), isClose ? "#ff6f66" : "#e9eef5");
  }
  car(pen, WIDE / 2, TALL - 4, 26, "#5b93ff");
}

function car(pen: CanvasRenderingContext2D, x: number, y: number, wide: number, colour: string): void {
  const tall = 0.72 * wide;
  pen.fillStyle = colour;
  pen.beginPath();
  pen.roundRect(x - wide / 2, y - 0.55 * tall, wide, 0.5 * tall, 0.1 * wide);
  pen.roundRect(x - 0.38 * wide, y - tall, 0.76 * wide, 0.55 * tall, 0.16 * wide);
  pen.fill();
  pen.fillStyle = "#c0392b";
  for (const side of [-1, 1])
    pen.fillRect(x + side * 0.34 * wide - 0.08 * wide, y - 0.42 * tall, 0.16 * wide, 0.13 * tall);
}
