// A run in three dimensions: played, paused, wound, seen from four sides.
import { el } from "./dom";
import { type Recording, readRecording } from "./scene/data";
import { buildInstruments } from "./scene/instruments";
import { createDriving } from "./scene/live";
import { FINEST } from "./scene/quality";
import { Resolution } from "./scene/resolution";
import { sensorColour } from "./scene/sensors";
import { buildStage, VIEWS, type View } from "./scene/stage";

const SPEEDS = [0.25, 0.5, 1, 2, 4];
const WIND = 1; // s
const DETAILS: Record<number, number> = { 1: 0, 2: 1, 3: 2, 4: 3 };

async function start(): Promise<void> {
  const page = document.getElementById("scene")!;
  document.documentElement.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  try {
    const recording = await readRecording();
    play(page, recording);
    document.documentElement.dataset.ready = "yes";
  } catch (error) {
    const canWebGl = Boolean(document.createElement("canvas").getContext("webgl2"));
    const hint = canWebGl ? "" : " This browser or machine has no WebGL.";
    page.replaceChildren(el("p", { class: "problem" }, `The scene cannot be shown: ${String(error)}.${hint}`));
    throw error;
  }
}

/** What the address asks for: a moment, a camera, and whether it is a picture that is taken. */
function asked(): { time: number | null; view: View | null; isPicture: boolean; detail: number } {
  const told = new URLSearchParams(location.hash.slice(1));
  const view = VIEWS.find(([name]) => name === told.get("view"))?.[0] ?? null;
  return {
    time: told.has("t") ? Number(told.get("t")) || 0 : null,
    view,
    isPicture: told.has("picture"),
    detail: DETAILS[Number(told.get("detail"))] ?? FINEST,
  };
}

function play(page: HTMLElement, recording: Recording): void {
  const first = asked();
  document.documentElement.classList.toggle("picture", first.isPicture);
  let time = Math.min(Math.max(first.time ?? 0, 0), recording.seconds);
  let view: View = first.view ?? "chase";
  let speed = 1;
  const still = first.detail; // of what does not move
  let isPlaying = first.time === null;
  let shown = -1;

  const canvas = el("canvas", {
    class: "stage",
    role: "img",
    "aria-label": `${recording.document.title}, ${recording.document.subtitle}, in three dimensions`,
  });
  const stage = buildStage(canvas, recording);
  const jump = (to: number): void => {
    time = Math.min(Math.max(to, 0), recording.seconds);
    shown = -1;
  };
  const instruments = buildInstruments(recording, jump);
  const clock = el("output", { class: "clock" });
  const slider = el("input", {
    type: "range",
    min: 0,
    max: recording.seconds,
    step: "any",
    "aria-label": "Time in s",
    input: () => jump(Number(slider.value)),
  });
  const button = el("button", { type: "button", class: "play", click: () => set(!isPlaying) });
  const set = (playing: boolean): void => {
    if (playing && time >= recording.seconds) time = 0;
    isPlaying = playing;
    button.textContent = playing ? "\u275a\u275a" : "\u25b6";
    button.setAttribute("aria-label", playing ? "Pause" : "Play");
  };
  set(isPlaying);
  const rate = el("select", { "aria-label": "Speed of the replay", change: () => (speed = Number(rate.value)) });
  for (const each of SPEEDS) rate.append(el("option", { value: each }, `${each}\u00d7`));
  rate.value = "1";
  const cameras = VIEWS.map(([name, title]) =>
    el("button", { type: "button", "data-view": name, click: () => choose(name) }, title),
  );
  const choose = (name: View): void => {
    view = name;
    shown = -1;
    for (const each of cameras) each.setAttribute("aria-pressed", String(each.dataset.view === name));
  };
  choose(view);
  const sensors = el("input", {
    type: "checkbox",
    checked: true,
    change: () => {
      stage.sensing.set(sensors.checked);
      shown = -1;
    },
  });
  const legend = recording.document.sensors.map((sensor, number) =>
    el("li", {}, mark(sensorColour(number)), sensor.title),
  );
  const heading = el(
    "header",
    {},
    el("h1", {}, recording.document.title),
    el("span", { class: "muted" }, recording.document.subtitle),
  );
  const key = legend.length
    ? el("div", { class: "legend" }, el("label", {}, sensors, "Sensors"), el("ul", {}, ...legend))
    : null;
  const bar = el(
    "div",
    { class: "controls" },
    button,
    slider,
    clock,
    rate,
    el("div", { class: "cameras", role: "group", "aria-label": "Camera" }, ...cameras),
  );
  const beside = instruments.element;
  if (recording.document.live && !first.isPicture) {
    document.documentElement.classList.add("drives-on");
    beside.append(
      createDriving(
        recording,
        () => time,
        () => (shown = -1),
      ),
    );
  }
  page.replaceChildren(el("main", {}, canvas, el("div", { class: "over" }, heading, key), bar), beside);

  document.addEventListener("keydown", (event) => {
    if (event.target instanceof HTMLSelectElement || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === " " && !(event.target instanceof HTMLButtonElement)) set(!isPlaying);
    else if (event.key === "ArrowLeft" && event.target !== slider) jump(time - WIND);
    else if (event.key === "ArrowRight" && event.target !== slider) jump(time + WIND);
    else if (/^[1-4]$/.test(event.key)) choose(VIEWS[Number(event.key) - 1]![0]);
    else return;
    event.preventDefault();
  });
  addEventListener("hashchange", () => {
    const { time: to, view: by } = asked();
    if (by) choose(by);
    if (to === null) return;
    set(false);
    jump(to);
  });
  // Without a graphics card a moving picture is drawn coarser, until it moves; one that stands is drawn finely.
  const resolution = new Resolution(FINEST);
  let [drawn, detail] = [0, FINEST];
  const resize = (): void => {
    [drawn, detail] = isPlaying ? [resolution.value, resolution.detail] : [1, still];
    stage.resize(canvas.clientWidth, canvas.clientHeight, drawn, detail);
    document.documentElement.dataset.drawn = `${drawn.toFixed(2)} ${detail}`;
    shown = -1;
  };
  new ResizeObserver(resize).observe(canvas);

  let last = performance.now();
  const tick = (now: number): void => {
    if (isPlaying) {
      time = Math.min(time + ((now - last) / 1000) * speed, recording.seconds);
      if (time >= recording.seconds) set(false);
    }
    if (isPlaying) resolution.tell(now, now - last);
    last = now;
    if (drawn !== (isPlaying ? resolution.value : 1) || detail !== (isPlaying ? resolution.detail : still)) resize();
    if (time !== shown) {
      stage.show(time, view);
      instruments.show(time);
      slider.value = String(time);
      clock.textContent = `${time.toFixed(1)} / ${recording.seconds.toFixed(0)} s`;
      document.documentElement.dataset.frames = String(Number(document.documentElement.dataset.frames ?? 0) + 1);
      document.documentElement.dataset.at = String(time);
      document.documentElement.dataset.view = view;
      shown = time;
    }
    requestAnimationFrame(tick);
  };
  resize();
  requestAnimationFrame(tick);
}

function mark(colour: string): HTMLElement {
  const node = el("span", { class: "mark", "aria-hidden": "true" });
  node.style.background = colour;
  return node;
}

void start();
