import { deepEqual, equal } from "node:assert/strict";
import test from "node:test";
import { fragmentOf, readFragment } from "../src/address";
import { metric, requirement, stateOf, studyOf, variable } from "./study";

const STUDY = studyOf(4, {
  sampler: "full_factorial",
  number: Int32Array.from([10, 11, 12, 13]),
  variables: [
    variable("x", [0, 1, 0, 1]),
    variable("y", [0, 0, 1, 1]),
    variable("z", [0, 0, 0.5, 0.5]),
    variable("grip", [0, 1, 0, 1], { role: "condition" }),
  ],
  metrics: [metric("m", [1, 2, 3, 4])],
  requirements: [requirement(4, { atMost: 3 }), requirement(4, { atLeast: 1 })],
});
const START = stateOf(STUDY);

test("an address has only what was changed, and brings it back", () => {
  equal(fragmentOf(STUDY, START, START), "");
  const left = stateOf(STUDY, {
    view: "runs",
    x: 1,
    y: 2,
    fixed: [0, 0, 0.5, 1],
    zoom: { x: [0.25, 0.5], y: [0, 0.75] },
    fill: 0,
    thresholds: [
      { atMost: 2.5, atLeast: null },
      { atMost: null, atLeast: 1, off: true },
    ],
    brushes: [{ column: "metric.0", low: 1, high: 2 }],
    pins: [3, 0],
    selected: 2,
    filter: 1,
    sort: { column: "metric.0", descending: true },
    settings: { "runs.axes": "a&b=c,d" },
  });
  const text = fragmentOf(STUDY, left, START);
  deepEqual({ ...START, ...readFragment(STUDY, text, START) }, left);
  equal(new URLSearchParams(text).get("pins"), "13,10");
  equal(new URLSearchParams(text).get("bounds"), "0::2.5,1:1::off");
});

test("an address of garbage changes nothing", () => {
  const garbage = [
    "view=nowhere&plane=9,9&fill=99&run=1e99&sort=&filter=7&pins=-1,1e9,x&configuration=d",
    "plane=1,1&zoom=0:2:0:1&sort=metric.9:up",
    "%",
    "=&=&",
    "x".repeat(20_000),
    "%E0%A4%A=%",
  ];
  for (const text of garbage) {
    deepEqual({ ...START, ...readFragment(STUDY, text, START) }, START, text);
  }
  const { fixed, thresholds, brushes, zoom } = readFragment(
    STUDY,
    "fixed=a:b,77:1&bounds=0:x:y,99:1:1&brushes=metric.99:1:2,variable.0:9:1&zoom=1:2",
    START,
  );
  deepEqual([fixed, thresholds, brushes, zoom], [START.fixed, START.thresholds, [], null]);
});

test("what fits in part is kept in part", () => {
  // A bound that the study does not have cannot be set; a value goes to the nearest level; five runs are pinned at most.
  deepEqual(readFragment(STUDY, "bounds=0:7:2,1::5", START).thresholds, [
    { atMost: 2, atLeast: null },
    { atMost: null, atLeast: 1 },
  ]);
  deepEqual(readFragment(STUDY, "fixed=2:0.4", START).fixed, [0, 0, 0.5, NaN]);
  deepEqual(readFragment({ ...STUDY, sampler: "scattered" }, "fixed=2:0.4,3:0.4", START).fixed, [0, 0, 0.4, 0]);
  deepEqual(readFragment(STUDY, "pins=10,11,10,12,99", START).pins, [0, 1, 2]);
  deepEqual(readFragment(studyOf(9, {}), "pins=8,7,6,5,4,3,2", START).pins, [8, 7, 6, 5, 4]);
  const keys = readFragment(STUDY, "__proto__.x=1&constructor.y=2&plain=3", START).settings!;
  deepEqual(Object.keys(keys), ["__proto__.x", "constructor.y"]);
});
