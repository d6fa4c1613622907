import { deepEqual, equal } from "node:assert/strict";
import test from "node:test";
import { deflateSync } from "node:zlib";
import { type Entry, unpack } from "../src/packing";
import type { Figure } from "../src/study";
import { decode } from "../src/waveform";

function packed(...bytes: number[]): string {
  return btoa(String.fromCharCode(...deflateSync(Uint8Array.from(bytes))));
}

test("a block has the bytes of each number apart, as packing.py writes it", async () => {
  // The block of tests/report/test_report_packing.py.
  const directory: Entry[] = [
    { name: "a", kind: "u2", length: 2 },
    { name: "b", kind: "u1", length: 2 },
  ];
  const arrays = await unpack(directory, packed(2, 4, 1, 3, 1, 0));
  deepEqual(
    [...arrays],
    [
      ["a", Uint16Array.from([0x0102, 0x0304])],
      ["b", Uint8Array.from([1, 0])],
    ],
  );
});

test("floats and integers come back with their signs", async () => {
  const values = Float64Array.from([-1.5, 1e300, NaN]);
  const bytes = new Uint8Array(values.buffer);
  const apart = Array.from({ length: 24 }, (_, i) => bytes[(i % 3) * 8 + Math.floor(i / 3)]!);
  const integer = [0xfe, 0xff, 0xff, 0xff];
  const directory: Entry[] = [
    { name: "f", kind: "f8", length: 3 },
    { name: "none", kind: "f4", length: 0 },
    { name: "i", kind: "i4", length: 1 },
  ];
  const arrays = await unpack(directory, packed(...apart, ...integer));
  deepEqual(arrays.get("f"), values);
  deepEqual(arrays.get("none"), new Float32Array(0));
  deepEqual(arrays.get("i"), Int32Array.from([-2]));
});

function figureOf(facts: Partial<Figure>): Figure {
  return {
    name: "gap",
    title: "Gap",
    unit: "m",
    current: "gap",
    target: "",
    shape: "waveform",
    time: Float64Array.from([0, 1, 2, 3]),
    row: new Map([
      [7, 0],
      [9, 1],
    ]),
    constants: null,
    ranges: { current: { low: Float64Array.from([0, -1]), high: Float64Array.from([65534, 1]) }, target: null },
    ...facts,
  };
}

test("a waveform is summed up from its second differences, with holes", () => {
  // Steps 5, 3, none and 65534 have the differences 5, -2, 65532, -1 (modulo 2^16), and these 5, -7, -2, 3.
  const folded = [10, 13, 3, 6];
  // Steps 32767, 32767, 65534, 0: differences 32767, 0, 32767, -65534 = 2; of these 32767, -32767, 32767, -32765.
  const other = [65534, 65533, 65534, 65529];
  const blocks = new Map([["figure.2.current", Uint16Array.from([...folded, ...other])]]);
  const figure = figureOf({});
  deepEqual(decode(figure, 2, 7, "current", blocks), [5, 3, null, 65534]);
  deepEqual(decode(figure, 2, 9, "current", blocks), [0, 0, 1, -1]);
  equal(decode(figure, 2, 8, "current", blocks), null);
  equal(decode(figure, 1, 7, "current", blocks), null);
  equal(decode(figure, 2, 7, "target", blocks), null);
});

test("a constant target is the same at all times", () => {
  const figure = figureOf({ shape: "constant", constants: Float64Array.from([40, 50]) });
  deepEqual(decode(figure, 0, 9, "target", new Map()), Float64Array.from([50, 50, 50, 50]));
});
