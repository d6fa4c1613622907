import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import { Controls, FULL, type KeyPress, press } from "../src/drive/controls";
import { readChoices, written } from "../src/drive/messages";
import { between, type Document } from "../src/scene/data";
import { Resolution } from "../src/scene/resolution";
import { openStream } from "../src/scene/stream";
import { near } from "./study";

function plugIn(pad: object | null): void {
  Object.defineProperty(globalThis, "navigator", { value: { getGamepads: () => [null, pad] }, configurable: true });
}

plugIn(null);

test("a pedal goes down as long as its key is pressed, and up faster", () => {
  const controls = new Controls(false, 20, 0);
  ok(controls.key("ArrowUp", true));
  ok(near(controls.values(0.25).accelerator!, 0.45));
  equal(controls.values(1).accelerator, 1);
  controls.key("ArrowUp", false);
  ok(near(controls.values(0.125).accelerator!, 0.5));
  // Two keys brake; one that is still pressed keeps the pedal down.
  controls.key("Space", true);
  controls.key("KeyS", true);
  controls.key("Space", false);
  ok(near(controls.values(0.1).brake!, 0.27));
  ok(near(controls.values(0.1).brake!, 0.54));
  controls.release();
  equal(controls.values(2).brake, 0);
});

const NOTHING = { look: () => {}, help: () => {}, finish: () => {} };
const down = (code: string, more: Partial<KeyPress> = {}): KeyPress => ({
  type: "keydown",
  code,
  ctrlKey: false,
  altKey: false,
  metaKey: false,
  repeat: false,
  isTaken: false,
  isHelp: false,
  ...more,
});

test("no pedal stays down, whatever is pressed in what order", () => {
  const keys = ["ArrowUp", "KeyW", "Space", "KeyH", "KeyA", "Control", "Meta", "Escape", "Tab", "KeyC"];
  let seed = 1;
  const random = (below: number): number => {
    seed = (seed * 48271) % 2147483647;
    return seed % below;
  };
  for (let drive = 0; drive < 10_000; drive++) {
    const controls = new Controls(false, 20, 0);
    const held = new Set<string>();
    let isHelp = false;
    const tell = (type: string, code: string): void => {
      const [ctrlKey, metaKey] = [held.has("Control"), held.has("Meta")];
      const told = down(code, { type, ctrlKey, metaKey, isHelp, isTaken: random(5) === 0 });
      press(controls, { ...NOTHING, help: () => (isHelp = true) }, told);
      if (code === "Escape") isHelp = false;
    };
    for (let event = 0; event < 20; event++) {
      const code = keys[random(keys.length)]!;
      if (held.delete(code)) {
        // Some systems do not tell what goes up while Meta is down.
        if (!held.has("Meta") || random(2)) tell("keyup", code);
      } else {
        held.add(code);
        tell("keydown", code);
      }
    }
    // Meta goes up last, and nobody tells what went up before.
    for (const code of [...held].filter((each) => each !== "Meta")) {
      held.delete(code);
      if (!held.has("Meta")) tell("keyup", code);
    }
    if (held.delete("Meta")) tell("keyup", "Meta");
    const { accelerator, brake, steering } = controls.values(5);
    deepEqual([accelerator, brake, steering], [0, 0, 0]);
  }
});

test("Escape brakes with any other key, over any field, and when the help is open", () => {
  for (const more of [{}, { ctrlKey: true }, { metaKey: true }, { isTaken: true }, { isHelp: true }]) {
    const controls = new Controls(false, 20, 0);
    press(controls, NOTHING, down("ArrowUp"));
    press(controls, NOTHING, down("Escape", more));
    equal(controls.values(1).brake, 1);
    press(controls, NOTHING, down("Escape", { ...more, type: "keyup" }));
    equal(controls.values(1).brake, 0);
  }
});

test("steering turns back faster than away, and hands stay at the wheel for a moment", () => {
  const controls = new Controls(false, 20, 0);
  controls.key("KeyA", true);
  const turned = controls.values(0.5);
  deepEqual([turned.steering, turned.hands_on], [0.45, 1]);
  controls.key("KeyA", false);
  controls.key("KeyD", true);
  ok(near(controls.values(0.25).steering!, 0.05));
  controls.key("KeyD", false);
  deepEqual([controls.values(0.5).hands_on, controls.values(0.5).hands_on], [1, 0]);
  equal(controls.values(0).steering, 0);
});

test("keys switch cruise control, its speed in steps of 5 km/h and its gap", () => {
  const controls = new Controls(false, 20, 3);
  ok(controls.key("KeyC", true));
  ok(!controls.key("KeyC", false));
  ok(!controls.key("KeyX", true));
  controls.key("Equal", true);
  controls.key("KeyG", true);
  const { cruise, set_speed: speed, gap_setting: gap } = controls.values(0);
  // 20 m/s are 72 km/h: the next step from the nearest one is 75 km/h.
  deepEqual([cruise, gap], [1, 0]);
  ok(near(speed! * 3.6, 75));
  for (let i = 0; i < 99; i++) controls.key("Minus", true);
  ok(near(controls.speed * 3.6, 5));
});

test("a gamepad drives, and a button that stays pressed switches once", () => {
  const buttons = (accelerator: number, a: number) =>
    Array.from({ length: 17 }, (_, i) => ({
      pressed: i === 0 && a > 0,
      value: i === 7 ? accelerator : 0,
    }));
  const controls = new Controls(false, 20, 0);
  plugIn({ mapping: "standard", axes: [-0.54, 0], buttons: buttons(0.6, 1) });
  const values = controls.values(1);
  ok(near(values.accelerator!, 0.6));
  ok(near(values.steering!, FULL / 2));
  equal(values.cruise, 1);
  equal(controls.values(1).cruise, 1);
  plugIn({ mapping: "standard", axes: [0.05, 0], buttons: buttons(0, 0) });
  const rest = controls.values(1);
  deepEqual([rest.accelerator, rest.steering], [0, 0]);
  plugIn({ mapping: "", axes: [1], buttons: buttons(1, 1) });
  equal(controls.values(1).accelerator, 0);
  plugIn(null);
});

test("what is chosen of a car comes back from the address", () => {
  const chosen = { "vehicle.brake": "disc", sensor: "radar" };
  deepEqual(readChoices(written(chosen)), chosen);
  deepEqual(readChoices("a:b:c,:x,y:,d:e"), { d: "e" });
});

test("angles are interpolated the short way round", () => {
  equal(between(1, 3, 0.25, false), 1.5);
  ok(near(between(3, -3, 0.5, true), Math.PI));
  ok(near(between(0.5, 0.5 + 4 * Math.PI, 0.5, true), 0.5));
});

const DOCUMENT = { title: "", step: 0.1 } as Document;

test("a stream is straight between its frames, and rolls with its speed", () => {
  const stream = openStream(DOCUMENT, ["host.speed", "heading", "light"], 10);
  equal(stream.at("heading", 1), 0);
  equal(stream.newest("light"), NaN);
  stream.add(0, Float64Array.from([10, 3, 2]));
  stream.add(0.1, Float64Array.from([20, -3, 5]));
  stream.add(0.1, Float64Array.from([99, 99, 99]));
  stream.add(0.3, Float64Array.from([20, -3, 5]));
  equal(stream.version, 3);
  deepEqual(stream.span(), [0, 0.3]);
  ok(near(stream.at("host.speed", 0.05), 15));
  ok(near(Math.abs(stream.angle("heading", 0.05)), Math.PI));
  deepEqual([stream.held("light", 0.05), stream.held("light", 0.1), stream.at("none", 0.1)], [2, 5, 0]);
  ok(near(stream.rolled(0.2), 4));
  ok(near(stream.rolled(0.3), 6));
  const seen: number[] = [];
  stream.each("light", (time, value) => seen.push(time, value));
  deepEqual(seen, [0, 2, 0.1, 5, 0.3, 5]);
});

test("frames that come unevenly are shown evenly and never backwards", () => {
  const stream = openStream(DOCUMENT, ["host.speed"], 10);
  // Frames every 100 ms, every second one 30 ms late; pictures every 20 ms.
  let frames = 0;
  let last = -Infinity;
  for (let now = 1000; now < 6000; now += 20) {
    while (1000 + 100 * frames + 30 * (frames % 2) <= now) stream.add(frames++ / 10, Float64Array.from([1]));
    const shown = stream.moment(now);
    ok(shown <= (frames - 1) / 10);
    if (now > 3000) ok(near(shown - last, 0.02, 0.008), `${shown - last} at ${now}`);
    last = shown;
  }
  // Without new frames it stays at the newest.
  for (let picture = 0; picture < 50; picture++) {
    const shown = stream.moment(6300);
    ok(shown >= last, `${shown} after ${last}`);
    last = shown;
  }
  // A gap of more than half a second is jumped over.
  stream.add(9, Float64Array.from([1]));
  ok(near(stream.moment(6300), 9 - 0.12));
});

test("pictures that take long are drawn coarser, and finer again when there is time", () => {
  const resolution = new Resolution();
  let now = 0;
  const run = (passed: number, seconds: number): void => {
    for (const end = now + 1000 * seconds; now < end; now += passed) resolution.tell(now, passed);
  };
  run(16, 3);
  equal(resolution.value, 1);
  run(54, 1);
  ok(near(resolution.value, Math.SQRT1_2, 0.08), `${resolution.value}`);
  run(90, 9);
  equal(resolution.value, 0.4);
  run(16, 20);
  equal(resolution.value, 1);
});
