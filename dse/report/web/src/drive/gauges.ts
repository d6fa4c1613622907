// What a driver looks at: speed with the speed that is set, the gap, who drives, and how well time is kept.
import { el } from "../dom";
import type { Controls } from "./controls";
import { GAPS } from "./controls";
import type { Drive } from "./messages";
import { meaningOf } from "./words";

const TOP = 180; // km/h
const FAR = 120; // m
const SLOWLY = 250; // ms between changes of what is only read

export interface Gauges {
  element: HTMLElement;
  show(time: number, controls: Controls): void;
}

export function buildGauges(drive: Drive): Gauges {
  const { stream } = drive;
  const { instruments } = stream.document;
  const speed = el("b", {});
  const set = el("span", { class: "set" });
  const arc = svg("path", { d: ARC, class: "track" });
  const hand = svg("path", { d: ARC, class: "now", pathLength: "100" });
  const mark = svg("circle", { r: "3.4", class: "wanted" });
  const dial = svg("svg", { viewBox: "0 0 100 74", "aria-hidden": "true" });
  dial.append(arc, hand, mark);
  const clock = el(
    "div",
    { class: "dial", role: "group", "aria-label": "Speed" },
    dial as unknown as HTMLElement,
    el("div", { class: "digits" }, speed, el("span", {}, "km/h")),
    set,
  );

  const distance = instruments.findIndex(({ unit, items }) => unit === "m" && !items.length);
  const bar = el("span", { class: "fill" });
  const metres = el("output", {});
  const chosen = el("span", { class: "muted" });
  const gap = el(
    "div",
    { class: "gap" },
    el("span", { class: "name" }, distance < 0 ? "Gap" : instruments[distance]!.title),
    metres,
    el("span", { class: "rail", "aria-hidden": "true" }, bar),
    chosen,
  );

  // What says nothing to a driver is among the signals.
  const modes = instruments.flatMap(({ items }, number) => {
    const meaning = items.length ? meaningOf(items) : null;
    return meaning ? [{ ...meaning, number, value: el("b", {}) }] : [];
  });
  const list = el(
    "dl",
    { class: "modes", "aria-label": "Modes" },
    ...modes.map(({ title, value }) => el("div", {}, el("dt", {}, title), el("dd", {}, value))),
  );
  const cruise = el("b", {});
  list.prepend(el("div", {}, el("dt", {}, "Cruise switch"), el("dd", {}, cruise)));
  const pedals = [el("span", { class: "fill" }), el("span", { class: "fill brake" })];
  const wheel = el("span", { class: "fill" });
  const inputs = el(
    "div",
    { class: "inputs", "aria-hidden": "true" },
    el("span", { class: "rail" }, pedals[0]),
    el("span", { class: "rail" }, pedals[1]),
    el("span", { class: "rail wheel" }, wheel),
  );
  const pace = el("p", {
    class: "pace",
    title: "Time of the drive; late steps; delay of the last step; latency from a key to its effect",
  });
  let last = 0;

  return {
    element: el("div", { class: "gauges" }, clock, gap, list, inputs, pace),
    show: (time, controls) => {
      const kmh = Math.max(0, stream.at("host.speed", time)) * 3.6;
      speed.textContent = kmh.toFixed(0);
      hand.setAttribute("stroke-dasharray", `${100 * Math.min(kmh / TOP, 1)} 200`);
      const wanted = controls.speed * 3.6;
      const turned = Math.PI * (1.15 - 1.3 * Math.min(wanted / TOP, 1));
      mark.setAttribute("cx", String(50 + 42 * Math.cos(turned)));
      mark.setAttribute("cy", String(50 - 42 * Math.sin(turned)));
      mark.classList.toggle("off", !controls.cruise);
      set.textContent = `${controls.cruise ? "set" : "off,"} ${wanted.toFixed(0)}`;
      const now = performance.now();
      if (now - last < SLOWLY / 2) return;
      last = now;
      const metre = distance < 0 ? NaN : stream.at(`instrument.${distance}`, time);
      metres.textContent = Number.isFinite(metre) ? `${metre.toFixed(0)} m` : "\u2013";
      bar.style.width = `${Number.isFinite(metre) ? 100 * Math.min(Math.max(metre / FAR, 0), 1) : 0}%`;
      bar.classList.toggle("close", metre < 0.5 * stream.at("host.speed", time));
      chosen.textContent = `set: ${GAPS[controls.gap]}`;
      cruise.textContent = controls.cruise ? "on" : "off";
      for (const { value, say, number } of modes) {
        const { text, level } = say(stream.newest(`instrument.${number}`));
        value.textContent = text;
        value.className = level;
      }
      const { accelerator, brake, steering } = controls.last;
      pedals[0]!.style.height = `${100 * accelerator!}%`;
      pedals[1]!.style.height = `${100 * brake!}%`;
      wheel.style.left = `${50 - 90 * steering!}%`;
      const echoes = [...drive.pace.echoes].sort((a, b) => a - b);
      const echo = echoes.length ? ` \u00b7 echo ${echoes[Math.floor(echoes.length / 2)]!.toFixed(0)} ms` : "";
      pace.textContent = `${time.toFixed(1)} s \u00b7 ${drive.pace.overruns} overruns \u00b7 ${(1000 * drive.pace.lateness).toFixed(1)} ms late${echo}`;
    },
  };
}

const ARC = arcOf(42);

function arcOf(radius: number): string {
  const at = (share: number): string => {
    const angle = Math.PI * (1.15 - 1.3 * share);
    return `${(50 + radius * Math.cos(angle)).toFixed(2)} ${(50 - radius * Math.sin(angle)).toFixed(2)}`;
  };
  return `M${at(0)} A${radius} ${radius} 0 1 1 ${at(1)}`;
}

function svg(tag: string, attributes: Record<string, string>): SVGElement {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}
