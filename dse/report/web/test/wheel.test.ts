import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import { Controls, FULL } from "../src/drive/controls";
import { labelOf } from "../src/drive/words";
import { near } from "./study";

// A wheel whose pedals rest at 1 and are at -1 when pressed; its driver showed it before.
const CALIBRATION = {
  steer: { axis: 0, low: -1, high: 1 },
  accelerate: { axis: 1, low: 1, high: -1 },
  brake: { axis: 2, low: 1, high: -1 },
};

function plugIn(...pads: object[]): void {
  const value = { getItem: () => JSON.stringify({ "a wheel": CALIBRATION }), setItem: () => {} };
  Object.defineProperty(globalThis, "localStorage", { value, configurable: true });
  Object.defineProperty(globalThis, "navigator", { value: { getGamepads: () => pads }, configurable: true });
}

const wheel = (...axes: number[]): object => ({ id: "a wheel", mapping: "", axes, buttons: [] });

test("a pedal of which the browser does not know yet where it is, is not pressed", () => {
  const controls = new Controls(false, 20, 0);
  plugIn(wheel(0, 0, 0));
  let { accelerator, brake, steering } = controls.values(1);
  deepEqual([accelerator, brake, steering], [0, 0, 0]);
  plugIn(wheel(-0.5, -1, 1));
  ({ accelerator, brake, steering } = controls.values(1));
  deepEqual([accelerator, brake], [1, 0]);
  ok(near(steering!, FULL / 2));
  // From now on 0 is a pedal that is half pressed, until the wheel is plugged in again.
  plugIn(wheel(0, 0, 1));
  equal(controls.values(1).accelerator, 0.5);
  plugIn();
  equal(controls.values(1).accelerator, 0);
  plugIn(wheel(0, 0, 0));
  equal(controls.values(1).accelerator, 0);
  plugIn();
});

test("a wheel that was calibrated drives, also beside a gamepad", () => {
  const controls = new Controls(false, 20, 0);
  const gamepad = { id: "a gamepad", mapping: "standard", axes: [0, 0], buttons: [] };
  plugIn(gamepad, wheel(1, 1, 0.5));
  const { brake, steering } = controls.values(1);
  deepEqual([brake, steering], [0.25, -FULL]);
  plugIn();
});

test("a slider is called in words, with what its component says of it", () => {
  deepEqual(labelOf("rear_axle.controller.max_steering", "of the front wheels"), {
    part: "Rear axle \u203a Controller",
    label: "Maximum steering",
    note: "of the front wheels",
  });
  deepEqual(labelOf("aeb.partial_ttc", "partial_ttc"), {
    part: "Emergency brake",
    label: "Partial time to collision",
    note: "",
  });
});
