// The drive itself: the scene over the whole width, what a driver looks at, and who drives.
import { el } from "../dom";
import { buildInstruments } from "../scene/instruments";
import { FINEST } from "../scene/quality";
import { Resolution } from "../scene/resolution";
import { sensorColour } from "../scene/sensors";
import { buildStage, type View } from "../scene/stage";
import { buildAssistance } from "./assistance";
import { Controls, GAPS, KEYS, press } from "./controls";
import { buildGauges } from "./gauges";
import type { Drive, Tunable } from "./messages";
import { buildSounding } from "./sounding";
import { buildTouch } from "./touch";
import { buildCalibration } from "./wheel";
import { labelOf } from "./words";

const EVERY = 1000 / 30; // ms between two messages
const FEW = 8; // sliders that are shown at once
const CAMERAS: [View, string][] = [
  ["chase", "Chase"],
  ["driver", "Driver"],
  ["top", "Top"],
];

/** Shows the drive in *page*; what it gives back ends the showing. */
export function showDrive(page: HTMLElement, drive: Drive): () => void {
  const { stream, first } = drive;
  const { title, subtitle, sensors, instruments } = stream.document;
  const controls = new Controls(Boolean(first.cruise), first.set_speed ?? 80 / 3.6, first.gap_setting ?? 2);
  const canvas = el("canvas", { class: "stage", role: "img", "aria-label": `${title}, in three dimensions` });
  const stage = buildStage(canvas, stream);
  const gauges = buildGauges(drive);
  const assistance = buildAssistance(stream);
  gauges.element.append(assistance.element);
  const sounding = buildSounding(stream);
  const signals = buildInstruments(stream);
  let view: View = "chase";
  const cameras = CAMERAS.map(([name, text]) =>
    el("button", { type: "button", "data-view": name, click: () => look(name) }, text),
  );
  const look = (name: View): void => {
    view = name;
    for (const each of cameras) each.setAttribute("aria-pressed", String(each.dataset.view === name));
  };
  look(view);
  const rays = el("input", { type: "checkbox", checked: true, change: () => stage.sensing.set(rays.checked) });
  const help = buildHelp();
  const finish = el("button", { type: "button", class: "finish", click: () => drive.finish() }, "Finish");
  const legend =
    sensors.length &&
    el(
      "div",
      { class: "legend" },
      el("label", {}, rays, "Sensors"),
      el("ul", {}, ...sensors.map((each, number) => el("li", {}, mark(sensorColour(number)), each.title))),
    );
  const tools = el(
    "div",
    { class: "tools" },
    el("div", { class: "cameras", role: "group", "aria-label": "Camera" }, ...cameras),
    sounding.button,
    el("button", { type: "button", "aria-label": "Keys", click: () => help.showModal() }, "?"),
    finish,
  );
  const shown = el("details", { class: "panel signals" }, el("summary", {}, "Signals"), signals.element);
  const aside = el(
    "div",
    { class: "panels" },
    drive.tunables.length ? buildTuning(drive) : null,
    instruments.length ? shown : null,
  );
  page.replaceChildren(
    el(
      "main",
      { class: "drive waiting" },
      canvas,
      el("div", { class: "over" }, el("header", {}, el("h1", {}, title), el("span", {}, subtitle)), legend || null),
      tools,
      aside,
      gauges.element,
      buildTouch(controls),
      help,
    ),
  );

  // A key that means something where the focus is does not drive.
  const isTaken = ({ target, code }: KeyboardEvent): boolean =>
    target instanceof HTMLElement &&
    (target.matches("input[type=range]")
      ? code.startsWith("Arrow")
      : target.matches(":focus-visible:is(button, summary, input)") && code === "Space");
  // Whoever clicks with a mouse goes on driving with the keys.
  const leave = ({ detail, target }: MouseEvent): void => {
    const button =
      detail && target instanceof Element && target.closest<HTMLElement>("button, summary, input[type=checkbox]");
    if (button && !help.contains(button)) button.blur();
  };
  const actions = {
    look: (camera: number) => look(CAMERAS[camera]![0]),
    help: () => help.showModal(),
    finish: () => drive.finish(),
  };
  const key = (event: KeyboardEvent): void => {
    const { type, code, ctrlKey, altKey, metaKey, repeat } = event;
    const told = { type, code, ctrlKey, altKey, metaKey, repeat, isTaken: isTaken(event), isHelp: help.open };
    if (press(controls, actions, told)) event.preventDefault();
  };
  const release = (): void => controls.release();
  const wires = new AbortController();
  document.addEventListener("keydown", key, { signal: wires.signal });
  document.addEventListener("keyup", key, { signal: wires.signal });
  page.addEventListener("click", leave, { signal: wires.signal });
  for (const lost of ["blur", "contextmenu", "pagehide"])
    window.addEventListener(lost, release, { signal: wires.signal });
  document.addEventListener("visibilitychange", release, { signal: wires.signal });

  let said: Record<string, number> = {};
  const say = (passed: number): void => {
    const values = controls.values(passed);
    const changed = Object.entries(values).filter(
      ([name, value]) => drive.controls.includes(name) && said[name] !== value,
    );
    if (!changed.length) return;
    drive.send("control", Object.fromEntries(changed));
    said = { ...said, ...Object.fromEntries(changed) };
  };
  // In a clock of its own: who drives is heard also while pictures come slowly.
  let spoken = performance.now();
  const speaking = window.setInterval(() => {
    const now = performance.now();
    say(Math.min((now - spoken) / 1000, 0.2));
    spoken = now;
  }, EVERY);

  const resolution = new Resolution(FINEST);
  const resize = (): void => stage.resize(canvas.clientWidth, canvas.clientHeight, resolution.value, resolution.detail);
  const watching = new ResizeObserver(resize);
  watching.observe(canvas);
  let last = performance.now();
  let frame = 0;
  let pictures = 0;
  const tick = (now: number): void => {
    if (resolution.tell(now, now - last)) resize();
    last = now;
    if (stream.version) {
      const time = stream.moment(now);
      // Before the first data nothing is shown, least of all pedals.
      if (!pictures) page.querySelector(".waiting")?.classList.remove("waiting");
      stage.show(time, view);
      gauges.show(time, controls);
      assistance.show(time);
      sounding.hear(time);
      if (shown.open) signals.show(time);
      document.documentElement.dataset.frames = String(++pictures);
    }
    frame = requestAnimationFrame(tick);
  };
  frame = requestAnimationFrame(tick);
  return () => {
    cancelAnimationFrame(frame);
    clearInterval(speaking);
    watching.disconnect();
    wires.abort();
    help.close();
    sounding.close();
    stage.close();
  };
}

function buildTuning(drive: Drive): HTMLElement {
  const row = ({ name, title, unit, min, max, value }: Tunable): HTMLElement => {
    const output = el("output", {});
    const { label, note } = labelOf(name, title);
    const slider = el("input", {
      type: "range",
      min,
      max,
      step: "any",
      value,
      "aria-label": note ? `${label}: ${note}` : label,
      input: () => {
        tell();
        waiting = true;
      },
    });
    const tell = (): void => {
      output.textContent = `${Number(Number(slider.value).toPrecision(3))} ${unit === "1" ? "" : unit}`.trim();
    };
    let waiting = false;
    tell();
    sliders.push(() => {
      if (!waiting) return {};
      waiting = false;
      return { [name]: Number(slider.value) };
    });
    return el("label", {}, el("span", { title: name }, label), output, note ? el("small", {}, note) : null, slider);
  };
  const sliders: (() => Record<string, number>)[] = [];
  const parts = new Map<string, Tunable[]>();
  for (const each of drive.tunables) {
    const { part } = labelOf(each.name, each.title);
    parts.set(part, [...(parts.get(part) ?? []), each]);
  }
  const isOpen = drive.tunables.length <= FEW;
  const groups = [...parts].map(([part, each]) =>
    el("details", { open: isOpen }, el("summary", {}, part), ...each.map(row)),
  );
  const panel = el("details", { class: "panel tuning" }, el("summary", {}, "Tuning"), ...groups);
  let timer = 0;
  panel.addEventListener("input", () => {
    if (timer) return;
    timer = window.setTimeout(() => {
      timer = 0;
      const values: Record<string, number> = Object.assign({}, ...sliders.map((each) => each()));
      if (Object.keys(values).length) drive.send("tune", values);
    }, EVERY);
  });
  return panel;
}

function buildHelp(): HTMLDialogElement {
  const rows = KEYS.map(([key, what]) => el("div", {}, el("dt", {}, key), el("dd", {}, what)));
  const dialog = el(
    "dialog",
    { class: "help", "aria-label": "Keys" },
    el("h2", {}, "Keys"),
    el("dl", {}, ...rows),
    el(
      "p",
      { class: "muted" },
      `Gamepad: triggers for the pedals, left stick to steer, A cruise control, B gap (${GAPS.join(", ")}), bumpers for the set speed. With hands off the wheel, lane keeping steers, if the car has it.`,
    ),
    buildCalibration(() => undefined),
    el("button", { type: "button", autofocus: true, click: () => dialog.close() }, "Resume"),
  );
  return dialog;
}

function mark(colour: string): HTMLElement {
  const node = el("span", { class: "mark", "aria-hidden": "true" });
  node.style.background = colour;
  return node;
}
