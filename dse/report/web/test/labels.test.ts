import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import { drawAxes, fitted, frameOf } from "../src/plot/frame";
import { labelBoundary, labelRegion, type Spot } from "../src/plot/labels";
import type { Pen, Ring } from "../src/plot/pen";
import type { Palette } from "../src/theme";
import { near } from "./study";

const FRAME = frameOf(482, 464, { x: [0, 4], y: [0, 4] }, false);
const COLOURS = { font: "sans", plot: "white", muted: "grey" } as Palette;

interface Written {
  text: string;
  x: number;
  y: number;
  angle: number;
}

/** A pen whose letters are seven pixels wide, and what it wrote. */
function penOf(): { pen: Pen; written: Written[] } {
  const written: Written[] = [];
  let at = { x: 0, y: 0, angle: 0 };
  const pen = {
    measureText: (text: string) => ({ width: 7 * text.length }),
    save: () => undefined,
    restore: () => {
      at = { x: 0, y: 0, angle: 0 };
    },
    translate: (x: number, y: number) => {
      at = { ...at, x, y };
    },
    rotate: (angle: number) => {
      at = { ...at, angle };
    },
    strokeText: () => undefined,
    fillText: (text: string) => written.push({ text, ...at }),
  };
  return { pen: pen as unknown as Pen, written };
}

const anywhere = (): boolean => true;

test("a name is written beside the middle of its boundary, along it, and upright", () => {
  const level: Ring = [
    [466, 200],
    [66, 200],
  ];
  const { pen, written } = penOf();
  const taken: Spot[] = [];
  labelBoundary(pen, FRAME, [level], "no overshoot", "red", COLOURS, taken, anywhere);
  equal(written.length, 1);
  const { text, x, y, angle } = written[0]!;
  equal(text, "no overshoot");
  ok(near(x, 266, 8), `${x}`);
  ok(near(Math.abs(y - 200), 11), `${y}`);
  // From right to left the letters would stand on their heads.
  ok(near(Math.abs(angle), 0, 1e-9), `${angle}`);
  equal(taken.length, Math.round((7 * 12 + 10) / 14) + 1);
  const steep: Ring = [
    [266, 400],
    [266, 30],
  ];
  labelBoundary(pen, FRAME, [steep], "steep", "red", COLOURS, [], anywhere);
  ok(near(Math.abs(written[1]!.angle), Math.PI / 2));
});

test("names do not collide, and stay on the side that is free", () => {
  const level: Ring = [
    [66, 200],
    [466, 200],
  ];
  const { pen, written } = penOf();
  const taken: Spot[] = [];
  for (const text of ["first", "second", "third"])
    labelBoundary(pen, FRAME, [level], text, "red", COLOURS, taken, (_, y) => y > 200);
  equal(written.length, 3);
  ok(written.every(({ y }) => y > 200));
  const places = written.map(({ x }) => x).sort((a, b) => a - b);
  ok(places[1]! - places[0]! > 7 * 5 && places[2]! - places[1]! > 7 * 5, places.join());
});

test("a name that does not fit its boundary is not written", () => {
  const { pen, written } = penOf();
  const small: Ring = [
    [200, 200],
    [230, 200],
  ];
  labelBoundary(pen, FRAME, [small], "much too long for it", "red", COLOURS, [], anywhere);
  // On the rim of the plot there is no boundary.
  const rim: Ring = [
    [66, 14],
    [466, 14],
  ];
  labelBoundary(pen, FRAME, [rim], "rim", "red", COLOURS, [], anywhere);
  labelBoundary(pen, FRAME, [[...small]], "no", "red", COLOURS, [], () => false);
  deepEqual(written, []);
});

const GRID = {
  xs: Float64Array.from({ length: 41 }, (_, i) => i / 10),
  ys: Float64Array.from({ length: 41 }, (_, i) => i / 10),
};

test("a region is named at its innermost place, line by line", () => {
  const { pen, written } = penOf();
  const taken: Spot[] = [];
  // The right half.
  const inside = (node: number): boolean => node % 41 >= 20;
  labelRegion(pen, FRAME, GRID, inside, ["not", "exercised"], "white", COLOURS, taken);
  deepEqual(
    written.map(({ text }) => text),
    ["not", "exercised"],
  );
  const [first, second] = written as [Written, Written];
  equal(first.x, second.x);
  ok(near(second.y - first.y, 15));
  ok(first.x > 266 + 7 * 4.5 && first.x < 466 - 7 * 4.5, `${first.x}`);
  ok(taken.length > 0);
  const before = taken.length;
  // Its place is taken, and the rest of it is too narrow.
  const row = 10 * FRAME.y.invert((first.y + second.y) / 2);
  const stripe = (node: number): boolean => node % 41 >= 20 && Math.abs(Math.floor(node / 41) - row) < 2.5;
  labelRegion(pen, FRAME, GRID, stripe, ["x".repeat(20)], "white", COLOURS, taken);
  equal(taken.length, before);
});

test("a region that is nowhere wide enough is not named", () => {
  const { pen, written } = penOf();
  labelRegion(pen, FRAME, GRID, (node) => node % 41 > 39, ["open"], "white", COLOURS, []);
  labelRegion(pen, FRAME, GRID, () => false, ["open"], "white", COLOURS, []);
  deepEqual(written, []);
});

test("every category has its label, which keeps the end that tells it from others", () => {
  const { pen, written } = penOf();
  const names = ["object_camera", "object_lidar", "object_radar_long", "object_radar_mid"];
  const frame = { ...FRAME, left: 66, right: 266, x: frameOf(282, 464, { x: [-0.5, 3.5], y: [0, 4] }, false).x };
  const drawn = Object.assign(pen, { beginPath() {}, moveTo() {}, lineTo() {}, stroke() {}, strokeRect() {} });
  drawAxes(drawn, frame, { title: "sensor", unit: "", names }, { title: "y", unit: "", names: ["a", "b"] }, COLOURS);
  const shown = written.map(({ text }) => text);
  equal(new Set(shown.slice(0, 4)).size, 4);
  ok(shown[0]!.endsWith("era") && shown[2]!.endsWith("ong") && shown[3]!.endsWith("mid"));
  equal(fitted(pen, "object_radar_long", 70), "objec\u2026long");
});
