import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import { maskOf, rebrushed } from "../src/brush";
import type { Fields } from "../src/plane/fields";
import { latticeFields, latticeOf } from "../src/plane/lattice";
import { createPlanes, fixedThrough, liesIn, movable, startingPoint } from "../src/plane/plane";
import { worstOf } from "../src/plane/worst";
import { above, below, type Ring } from "../src/plot/contour";
import { frameOf } from "../src/plot/frame";
import { regionsOf, sameOpen, scaleOf } from "../src/plot/regions";
import { movedBy, wholeOf, zoomedBy } from "../src/plot/zoom";
import type { Study, Variable } from "../src/study";
import { metric, near, requirement, stateOf, studyOf, variable } from "./study";

// y = x + z over a grid of both, 0, 1 … 4, run by run along x.
function grid(facts: Partial<Variable> = {}, study: Partial<Study> = {}) {
  const x = Array.from({ length: 25 }, (_, run) => run % 5);
  const z = Array.from({ length: 25 }, (_, run) => Math.floor(run / 5));
  return studyOf(25, {
    sampler: "full_factorial",
    variables: [
      variable("x", x, { high: 4, levels: 5, nominal: 1.2, ...facts }),
      variable("z", z, { high: 4, levels: 5, ...facts }),
    ],
    metrics: [
      metric(
        "y",
        x.map((each, run) => each + z[run]!),
      ),
    ],
    requirements: [requirement(25, { atMost: 3 })],
    ...study,
  });
}

function area(rings: Ring[]): number {
  const of = (ring: Ring): number =>
    ring.reduce((sum, [x, y], i) => {
      const [a, b] = ring[(i + 1) % ring.length]!;
      return sum + (x * b - a * y) / 2;
    }, 0);
  return Math.abs(rings.reduce((sum, ring) => sum + of(ring), 0));
}

const FRAME = frameOf(482, 464, { x: [0, 4], y: [0, 4] }, false);

test("a frame leaves room for axes and puts the origin below on the left", () => {
  deepEqual([FRAME.left, FRAME.right, FRAME.top, FRAME.bottom], [66, 466, 14, 414]);
  deepEqual([FRAME.x(0), FRAME.x(4), FRAME.y(0), FRAME.y(4)], [66, 466, 414, 14]);
});

test("runs on a grid are a lattice; half of one is none", () => {
  const { variables } = grid();
  const [x, z] = [variables[0]!.values, variables[1]!.values];
  const all = Int32Array.from(x.keys());
  const lattice = latticeOf(x, z, all)!;
  deepEqual([...lattice.xs], [0, 1, 2, 3, 4]);
  equal(lattice.runs[7], 7);
  ok(lattice.whole);
  equal(
    latticeOf(
      x,
      z,
      all.filter((run) => run % 2 === 0 && run > 0 && run < 20),
    ),
    null,
  );
  equal(latticeOf(x, z, all.slice(0, 5)), null);
});

test("more levels than pixels are thinned, with both ends", () => {
  const size = 500;
  const x = Float64Array.from({ length: 2 * size }, (_, run) => run >> 1);
  const z = Float64Array.from({ length: 2 * size }, (_, run) => run % 2);
  const lattice = latticeOf(x, z, Int32Array.from(x.keys()))!;
  deepEqual([lattice.xs.length, lattice.xs[0], lattice.xs.at(-1), lattice.whole], [240, 0, 499, false]);
});

test("a failed run takes the mean of its neighbours, and leaves a hole that is known", () => {
  const study = grid();
  study.done[12] = 0;
  study.metrics[0]!.values[12] = NaN;
  const { variables } = study;
  const fields = latticeFields(study, latticeOf(variables[0]!.values, variables[1]!.values, study.number)!);
  equal(fields.metric(0)[12], 4);
  const known = fields.known([0])!;
  deepEqual(
    Array.from(known, (value, node) => (value < 0.5 ? node : -1)).filter((node) => node >= 0),
    [12],
  );
  equal(latticeFields(grid(), latticeOf(variables[0]!.values, variables[1]!.values, study.number)!).known([0]), null);
  equal(fields.exercised(0), null);
});

test("a boundary of linear values is where it is by hand", () => {
  const study = grid();
  const plane = createPlanes(study)(stateOf(study));
  const fields = plane.fields!;
  ok(plane.note.includes("interpolated linearly"));
  // Above x + z = 3 is 16 less the triangle of 4.5, each unit 100 pixels wide; without the half cells beyond the rim.
  const inside = (rings: Ring[]): Ring[] =>
    rings.map((ring) => ring.map(([x, y]) => [Math.min(466, Math.max(66, x)), Math.min(414, Math.max(14, y))]));
  const values = fields.metric(0);
  ok(near(area(inside(above(values, fields, FRAME, 3))), 115000, 1));
  ok(near(area(inside(below(values, fields, FRAME, 3))), 45000, 1));
  deepEqual(above(values, fields, FRAME, 8), []);
  deepEqual(below(values, fields, FRAME, 0), []);
});

test("regions are the sides of bounds that count, and where runs exercise nothing", () => {
  const study = grid(
    {},
    {
      requirements: [
        requirement(25, { atMost: 6, atLeast: 2 }),
        requirement(25, { atMost: 3, exercised: Array.from({ length: 25 }, (_, run) => run % 5 < 2) }),
        requirement(25, { atMost: 5, exercised: Array.from({ length: 25 }, (_, run) => run % 5 < 2) }),
      ],
    },
  );
  const { fields } = createPlanes(study)(stateOf(study));
  const at = (off: boolean) =>
    study.requirements.map(({ atMost, atLeast }, index) => ({ atMost, atLeast, off: off && index === 1 }));
  const regions = regionsOf(study, fields!, at(false), FRAME);
  deepEqual(
    regions.sides.map(({ requirement: index, limit }) => [index, limit]),
    [
      [0, 6],
      [0, 2],
      [1, 3],
      [2, 5],
    ],
  );
  equal(regions.open[0]!.length, 0);
  ok(regions.open[1]!.length > 0);
  deepEqual(regions.unknown, []);
  // What the second and the third leave open is the same, and is drawn and named once.
  deepEqual(sameOpen(regions.open), [[1, 2]]);
  const without = regionsOf(study, fields!, at(true), FRAME);
  deepEqual(
    without.sides.map(({ requirement: index }) => index),
    [0, 0, 2],
  );
  deepEqual(without.open[1], []);
});

test("colours step evenly over the bulk of the values", () => {
  const values = Float64Array.from({ length: 101 }, (_, run) => (run === 100 ? 1e9 : run));
  const { domain, steps } = scaleOf(values, Int32Array.from(values.keys()));
  deepEqual(domain, [0, 100]);
  deepEqual(steps, [0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100]);
  deepEqual(scaleOf(Float64Array.from([NaN]), Int32Array.from([0])), { domain: [0, 1], steps: [0, 1] });
  const same = scaleOf(Float64Array.from([7, 7]), Int32Array.from([0, 1]));
  deepEqual(same.domain, [6.5, 7.5]);
});

test("a grid that lacks levels has no boundaries yet", () => {
  const plane = createPlanes(grid({ levels: 6 }))(stateOf(grid({ levels: 6 })));
  equal(plane.fields, null);
  ok(plane.note.includes("only the runs are shown, no boundaries"));
  equal(plane.on.length, 25);
});

test("between names there is nothing to interpolate", () => {
  const study = grid({ labels: ["a", "b", "c", "d", "e"] });
  const { fields, note } = createPlanes(study)(stateOf(study));
  equal(fields, null);
  equal(note, "There is nothing between the values of x: only the runs are shown, no boundaries.");
});

test("between a few listed values nothing is interpolated, and each has its even place and tick", () => {
  const study = grid({ apart: [0, 1, 2, 3, 4] });
  const { fields, note } = createPlanes(study)(stateOf(study));
  equal(fields, null);
  equal(note, "Nothing is known between the values of x: only the runs are shown, no boundaries.");
  const { x, y } = frameOf(482, 464, { x: [30, 10000], y: [0, 4] }, false, {
    x: { apart: [30, 50, 10000] },
    y: {},
  });
  ok([30, 50, 10000].every((value, index) => near(x(value), 66 + (400 / 6) * (1 + 2 * index), 1e-9)));
  equal(x.invert(266), 50);
  equal(y(2), 214);
  const { x: decades } = frameOf(482, 464, { x: [1, 100], y: [0, 4] }, false, { x: { log: true }, y: {} });
  ok([1, 10, 100].every((value, index) => near(decades(value), 66 + 200 * index, 1e-9)));
});

test("a plane has the runs at the fixed values, and moves through a run", () => {
  const study = studyOf(8, {
    sampler: "full_factorial",
    variables: [
      variable("x", [0, 1, 0, 1, 0, 1, 0, 1]),
      variable("y", [0, 0, 1, 1, 0, 0, 1, 1]),
      variable("z", [0, 0, 0, 0, 1, 1, 1, 1], { nominal: 0.8 }),
      variable("load", [0, 0, 0, 0, 0, 0, 0, 0], { role: "condition" }),
    ],
  });
  const start = startingPoint(study);
  deepEqual(start, [0, 0, 1, NaN]);
  const shown = stateOf(study, { fixed: start });
  deepEqual([...createPlanes(study)(shown).on], [4, 5, 6, 7]);
  const moved = fixedThrough(study, start, 1);
  deepEqual(moved, [1, 0, 0, NaN]);
  ok(liesIn(study, 1, { ...shown, fixed: moved }));
  ok(!liesIn(study, 5, { ...shown, fixed: moved }));
});

test("of a sliced study only the variables of a slice can be moved", () => {
  const names = ["a", "b", "c", "d"];
  const study = studyOf(0, {
    sampler: "sliced",
    slices: [
      [0, 1],
      [1, 2, 3],
    ],
    variables: names.map((name) => variable(name, [])),
  });
  deepEqual(movable(study, 1, 2), [3]);
  deepEqual(movable(study, 0, 2), []);
  deepEqual(movable({ ...study, sampler: "scattered" }, 0, 2), [1, 3]);
});

test("fields at several conditions are those of the worst that is exercised", () => {
  const one = (values: number[], exercised: number[] | null, known: number[] | null): Fields => ({
    xs: Float64Array.from([0, 1]),
    ys: Float64Array.from([0]),
    how: "Made up.",
    metric: () => Float64Array.from(values),
    exercised: () => exercised && Float64Array.from(exercised),
    known: () => known && Float64Array.from(known),
  });
  const both = worstOf([one([1, 5], [1, 0], [0, 1]), one([3, 2], [1, 1], [0, 0])]);
  deepEqual([...both.metric(0, "max", 0)], [3, 2]);
  deepEqual([...both.metric(0, "max", -1)], [3, 5]);
  deepEqual([...both.metric(0, "min", 0)], [1, 2]);
  deepEqual([...both.metric(0)], [2, 3.5]);
  deepEqual([...both.exercised(0)!], [1, 1]);
  deepEqual([...both.known([0])!], [0, 0]);
  equal(worstOf([one([1], null, null), one([2], null, null)]).known([0]), null);
  equal(both.how, "Made up. Each design is at the worst of 2 conditions.");
});

test("a zoom keeps its place and never leaves the plane", () => {
  const whole = wholeOf(grid(), { x: 0, y: 1 });
  deepEqual(whole, { x: [0, 4], y: [0, 4] });
  deepEqual(zoomedBy(whole, whole, 2, [1, 4]), { x: [0.5, 2.5], y: [2, 4] });
  equal(zoomedBy(whole, { x: [0.5, 2.5], y: [2, 4] }, 0.5, [1, 4]), null);
  const closest = zoomedBy(whole, whole, 1e9, [2, 2])!;
  ok(near(closest.x[1] - closest.x[0], 4 / 200));
  deepEqual(movedBy(whole, { x: [0.5, 2.5], y: [2, 4] }, -1, 1), { x: [0, 2], y: [2, 4] });
});

test("brushes on one column replace each other and keep what they caught", () => {
  const study = grid();
  equal(maskOf(study, []), null);
  const brushes = rebrushed([], "variable.0", [3.00000049, 0.99999951]);
  deepEqual(brushes, [{ column: "variable.0", low: 0.999999, high: 3.00001 }]);
  const both = rebrushed(brushes, "metric.0", [0, 2]);
  equal(
    maskOf(study, both)!.reduce((sum, one) => sum + one, 0),
    3,
  );
  deepEqual(rebrushed(both, "variable.0", null), [{ column: "metric.0", low: 0, high: 2 }]);
  study.metrics[0]!.values[1] = NaN;
  equal(maskOf(study, [{ column: "metric.0", low: -Infinity, high: Infinity }])![1], 0);
});
