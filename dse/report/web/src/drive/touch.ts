// Pedals and a wheel for fingers; the style sheet shows them where fingers are.
import { el } from "../dom";
import type { Controls } from "./controls";

export function buildTouch(controls: Controls): HTMLElement {
  const { fingers } = controls;
  const wheel = el(
    "div",
    {
      class: "wheel",
      role: "slider",
      "aria-label": "Steering",
      "aria-valuemin": -100,
      "aria-valuemax": 100,
      "aria-valuenow": 0,
    },
    el("span", {}, "\u2194"),
  );
  const knob = wheel.firstElementChild as HTMLElement;
  const steer = (share: number | null): void => {
    fingers.steer = share;
    knob.style.left = `${50 - 50 * (share ?? 0)}%`;
    wheel.setAttribute("aria-valuenow", String(Math.round(-100 * (share ?? 0))));
  };
  held(
    wheel,
    (x) => steer(Math.min(Math.max(1 - 2 * x, -1), 1)),
    () => steer(null),
  );
  const pedal = (what: "accelerate" | "brake", text: string): HTMLElement => {
    const node = el("button", { type: "button", class: `pedal ${what}` }, text);
    // The higher the finger on it, the deeper it is pressed.
    held(
      node,
      (_, y) => (fingers[what] = Math.min(Math.max(1.15 - y, 0.2), 1)),
      () => (fingers[what] = 0),
    );
    return node;
  };
  const tap = (text: string, label: string, what: () => void): HTMLElement =>
    el("button", { type: "button", "aria-label": label, click: what }, text);
  return el(
    "div",
    { class: "touch" },
    wheel,
    el(
      "div",
      { class: "taps" },
      tap("\u2212", "Set speed down", () => controls.faster(-1)),
      tap("Cruise", "Cruise control on or off", () => (controls.cruise = !controls.cruise)),
      tap("+", "Set speed up", () => controls.faster(1)),
      tap("Gap", "Change the gap", () => controls.key("KeyG", true)),
    ),
    el("div", { class: "pedals" }, pedal("brake", "Brake"), pedal("accelerate", "Go")),
  );
}

function held(node: HTMLElement, at: (x: number, y: number) => void, off: () => void): void {
  const tell = (event: PointerEvent): void => {
    const box = node.getBoundingClientRect();
    at((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
  };
  node.addEventListener("pointerdown", (event) => {
    node.setPointerCapture(event.pointerId);
    tell(event);
    event.preventDefault();
  });
  node.addEventListener("pointermove", (event) => {
    if (node.hasPointerCapture(event.pointerId)) tell(event);
  });
  for (const name of ["pointerup", "pointercancel"] as const) node.addEventListener(name, off);
}
