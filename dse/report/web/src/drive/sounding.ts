// Sound of the own car: off until it is switched on; B is the horn.
import { el } from "../dom";
import type { Stream } from "../scene/stream";
import { Sound } from "./sound";

export interface Sounding {
  button: HTMLElement;
  hear(time: number): void;
  close(): void;
}

export function buildSounding(stream: Stream): Sounding {
  const sound = new Sound();
  const button = el(
    "button",
    { type: "button", class: "sound", "aria-pressed": "false", "aria-label": "Sound" },
    "\u266a",
  );
  const toggle = (): void => {
    sound.toggle();
    button.setAttribute("aria-pressed", String(sound.isOn));
  };
  button.addEventListener("click", toggle);
  const wires = new AbortController();
  const key = ({ type, code, repeat, ctrlKey, altKey, metaKey }: KeyboardEvent): void => {
    if (code === "KeyB" && !repeat) sound.horn(type === "keydown" && !ctrlKey && !altKey && !metaKey);
    else if (code === "KeyM" && type === "keydown" && !repeat && !ctrlKey && !altKey && !metaKey) toggle();
  };
  for (const type of ["keydown", "keyup"] as const) document.addEventListener(type, key, { signal: wires.signal });
  for (const lost of ["blur", "pagehide"])
    window.addEventListener(lost, () => sound.horn(false), { signal: wires.signal });
  const radius = stream.document.host.wheel;
  return {
    button,
    hear: (time) => {
      const at = (name: string): number => stream.at(`host.${name}`, time);
      sound.hear({
        speed: at("speed"),
        spin: stream.has("host.spin") ? at("spin") : NaN,
        drive: stream.has("host.drive") ? at("drive") : 0,
        radius,
        wetness: Math.min(1, stream.at("weather.rain", time) * 1.8e6),
      });
    },
    close: () => {
      wires.abort();
      sound.close();
    },
  };
}
