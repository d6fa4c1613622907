import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import { groupingOf } from "../src/grouping";
import { boxOf } from "../src/views/designs/alternatives";
import { type Choices, readChoices, withChoices } from "../src/views/designs/choices";
import { type Aim, frontOf } from "../src/views/designs/front";
import { createModel } from "../src/views/designs/model";
import { topsis } from "../src/views/designs/topsis";
import { metric, near, random, requirement, storeOf, studyOf, variable } from "./study";

for (const aims of [1, 2, 3]) {
  test(`the front of ${aims} aims is what no other point dominates`, () => {
    const next = random(aims);
    const size = 150;
    // Few values, so that many points are equal, and sums that hardly differ, so that few are dominated by most.
    const rows = Array.from({ length: size }, () => {
      const first = Array.from({ length: aims - 1 }, () => Math.floor(6 * next()));
      const last = 12 - first.reduce((sum, each) => sum + each, 0) + Math.floor(3 * next());
      return [...first, last].map((each, aim) => (next() < 0.05 ? NaN : aim === 1 ? -each : each));
    });
    const columns: Aim[] = Array.from({ length: aims }, (_, aim) => ({
      values: Float64Array.from(rows, (row) => row[aim]!),
      maximize: aim === 1,
    }));
    const among = Uint8Array.from({ length: size }, () => Number(next() < 0.9));
    const cost = (point: number) => columns.map(({ values, maximize }) => (maximize ? -1 : 1) * values[point]!);
    const counts = (point: number) => among[point] && !cost(point).some(Number.isNaN);
    const dominates = (a: number[], b: number[]) =>
      a.every((one, i) => one <= b[i]!) && a.some((one, i) => one < b[i]!);
    const points = [...among.keys()];
    const wanted = points.map((point) =>
      Number(counts(point) && !points.some((other) => counts(other) && dominates(cost(other), cost(point)))),
    );
    deepEqual([...frontOf(columns, among)], wanted);
    ok(wanted.includes(1));
  });
}

test("without an aim nothing is on the front", () => {
  deepEqual([...frontOf([], Uint8Array.from([1, 1]))], [0, 0]);
});

test("TOPSIS of three designs is what it is by hand", () => {
  // Sums of squares of 49 and 81: costs are 2/7, 3/7, 6/7 of their norm, ranges 1/9, 4/9, 8/9; each counts half.
  const cost = { values: Float64Array.from([2, 3, 6, NaN]), maximize: false, weight: 3 };
  const range = { values: Float64Array.from([1, 4, 8, 5]), maximize: true, weight: 3 };
  const scores = topsis([cost, range], Uint8Array.from([1, 1, 1, 1]));
  const best = Math.hypot(1 / 14, 2 / 9);
  const worst = Math.hypot(3 / 14, 1 / 6);
  const wanted = [36 / 85, worst / (worst + best), 49 / 85, NaN];
  ok([...scores].every((score, point) => near(score, wanted[point]!)));
  // What does not count changes no norm; a weight of 0 leaves the other criterion alone.
  const first = topsis([cost, { ...range, weight: 0 }], Uint8Array.from([1, 0, 1, 1]));
  deepEqual([...first], [1, NaN, 0, NaN]);
  deepEqual([...topsis([{ ...cost, values: Float64Array.from([2, 2]) }], Uint8Array.from([1, 1]))], [NaN, NaN]);
});

test("a box has the quartiles of numpy", () => {
  // numpy.quantile([1, 2, 4, 8], [0, 0.25, 0.5, 0.75, 1])
  deepEqual(boxOf([8, 1, 4, 2]), { low: 1, first: 1.75, median: 3, third: 5, high: 8, count: 4 });
  deepEqual(boxOf([3]), { low: 3, first: 3, median: 3, third: 3, high: 3, count: 1 });
  equal(boxOf([]), null);
});

// Three configurations at two gains, each at two slopes; a gap of at least 10 m is required.
function priced() {
  const kinds = ["camera", "radar", "lidar"];
  const rows = Array.from({ length: 12 }, (_, run) => ({ kind: run >> 2, gain: (run >> 1) % 2, slope: 5 * (run % 2) }));
  return studyOf(12, {
    configuration: Int32Array.from(rows, ({ kind }) => kind),
    number: Int32Array.from(rows, (_, run) => 100 + run),
    configurations: kinds.map((kind) => ({
      id: kind,
      choices: [["sensor", kind] as [string, string]],
      properties: [],
      picture: -1,
      parts: [],
      radial: null,
      noisy: false,
      allocations: [],
    })),
    variables: [
      variable(
        "gain",
        rows.map(({ gain }) => gain),
      ),
      variable(
        "slope",
        rows.map(({ slope }) => slope),
        { high: 5, role: "condition" },
      ),
    ],
    metrics: [
      metric(
        "gap",
        rows.map(({ kind, gain, slope }) => 8 + 2 * kind + gain - 0.1 * slope),
      ),
    ],
    requirements: [requirement(12, { atLeast: 10 })],
    properties: [
      {
        name: "cost",
        title: "cost",
        unit: "EUR",
        isPrice: true,
        values: Float64Array.from([100, 300, 900]),
        text: String,
      },
    ],
    objectives: [
      { column: "property.0", maximize: false },
      { column: "metric.0", maximize: true },
    ],
  });
}

test("runs that differ only in conditions are one design, in the order of first runs", () => {
  const { size, first, of, conditions, whole } = groupingOf(priced());
  deepEqual([size, conditions], [6, 2]);
  deepEqual([...first], [0, 2, 4, 6, 8, 10]);
  deepEqual([...of], [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]);
  deepEqual([...whole], [1, 1, 1, 1, 1, 1]);
});

test("feasible designs have a front and scores, within the margin and the brushes", () => {
  const store = storeOf(priced());
  const model = createModel(store);
  // At the worst slope the gaps are 7.5, 8.5, 9.5, 10.5, 11.5, 12.5.
  deepEqual([...model.standing().mark], [1, 1, 1, 0, 0, 0]);
  deepEqual([...model.front()], [0, 0, 0, 1, 0, 1]);
  deepEqual([...model.scores()].map(Number.isNaN), [true, true, true, false, false, false]);
  model.set({ criteria: [{ column: "property.0", maximize: true, weight: 5 }] });
  deepEqual([...model.front()], [0, 0, 0, 0, 1, 1]);
  model.set({ demand: 0.1 });
  deepEqual([...model.standing().mark], [1, 1, 1, 1, 0, 0]);
  store.set({ brushes: [{ column: "variable.0", low: 0, high: 0.5 }] });
  deepEqual([...model.front()], [0, 0, 0, 0, 1, 0]);
  // A condition that is brushed lets a design through if any of its runs is within.
  store.set({ brushes: [{ column: "variable.1", low: 4, high: 6 }] });
  deepEqual([...model.within()!], [1, 1, 1, 1, 1, 1]);
});

test("choices come back from the settings they were written into", () => {
  const study = priced();
  const start = createModel(storeOf(study)).choices;
  const chosen: Choices = {
    demand: 0.15,
    criteria: [{ column: "metric.0", maximize: false, weight: 9 }],
    x: "variable.0",
    y: "metric.0",
    colour: "place.sensor",
    points: "runs",
    picked: [5, 1],
    sort: { column: "design", descending: false },
    boxes: "metric.0",
    among: "feasible",
    case: 3,
  };
  const settings = withChoices(study, { "runs.axes": "kept", "designs.old": "gone" }, chosen, start);
  equal(settings["runs.axes"], "kept");
  equal(settings["designs.old"], undefined);
  equal(settings["designs.picked"], "110,102");
  deepEqual(readChoices(study, settings, start, start), chosen);
  deepEqual(withChoices(study, {}, start, start), {});
  // No criterion at all is a choice, too.
  const none = withChoices(study, {}, { ...start, criteria: [] }, start);
  deepEqual(readChoices(study, none, start, start).criteria, []);
});

test("choices that are made up change nothing", () => {
  const study = priced();
  const start = createModel(storeOf(study)).choices;
  const odd: Record<string, string> = {
    demand: "9",
    criteria: "<b>:max:5,metric.0:max:-1,metric.7:max:1",
    x: "metric.77",
    y: "",
    case: "x",
    colour: "place.<img src=x onerror=window.pwned=1>",
    points: "both",
    picked: "99999,-1,x",
    sort: "x",
    boxes: "variable.1",
    among: "some",
  };
  const settings = Object.fromEntries(Object.entries(odd).map(([key, value]) => [`designs.${key}`, value]));
  deepEqual(readChoices(study, settings, start, start), start);
  equal(Object.keys(odd).length, Object.keys(start).length);
});
