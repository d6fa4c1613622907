// What a page that simulates makes of points, values and choices.
import assert from "node:assert/strict";
import test from "node:test";
import type { SimulationDocument } from "../src/simulate/document";
import type { Ran } from "../src/simulate/engine";
import { coarseFirst, gridStudy, LEVELS, valueAt } from "../src/simulate/grid";
import { controlsOf } from "../src/simulate/sliders";
import { simulatedStudy } from "../src/yaml";
import { metric, requirement, studyOf } from "./study";

const X = { name: "a.x", title: "x", unit: "m", low: 1, high: 25 };
const Y = { name: "a.y", title: "y", unit: "", low: -24, high: 0 };

test("coarse grids come first, and each is part of the next", () => {
  const { nodes, stages } = coarseFirst();
  assert.deepEqual(
    stages.map(({ size }) => size),
    [49, 169, 625],
  );
  assert.equal(new Set(nodes).size, 625);
  const corners = [0, LEVELS - 1, LEVELS * (LEVELS - 1), LEVELS * LEVELS - 1];
  assert.ok(corners.every((node) => nodes.indexOf(node) < 49));
});

test("a grid is a study of its two axes, with the runs where they are", () => {
  const study = studyOf(1, { metrics: [metric("m", [0])], requirements: [requirement(1, { atMost: 100 })] });
  const runs = Array.from({ length: LEVELS * LEVELS }, (_, node): Ran => {
    const [x, y] = [valueAt(X, node % LEVELS), valueAt(Y, Math.floor(node / LEVELS))];
    return {
      problem: node ? "" : "it broke",
      metrics: Float64Array.of(100 * x + y),
      marks: Uint8Array.of(node === LEVELS - 1 ? 2 : 0),
      close: Uint8Array.of(0),
      traces: [],
      columns: {},
    };
  });
  for (const stride of [4, 2, 1]) {
    const made = gridStudy(study, [X, Y], runs, stride);
    assert.equal(made.size, (24 / stride + 1) ** 2);
    const [x, y] = made.variables;
    const values = made.metrics[0]!.values;
    assert.deepEqual(
      Array.from(values),
      Array.from(x!.values, (value, run) => 100 * value + y!.values[run]!),
    );
    assert.equal(made.done.indexOf(0), 0);
    assert.equal(made.problems.get(0), "it broke");
    assert.equal(made.requirements[0]!.exercised.indexOf(0), 24 / stride);
  }
});

const setting = (name: string, low: number | null, high: number | null) =>
  ({ name, title: name, unit: "", factor: 1, offset: 0, kind: "real", items: [], low, high }) as const;

test("a slider has the study's range, else the parameter's, else one around its value", () => {
  const settings = [
    setting("a.free", null, null),
    setting("a.bounded", 0, 5),
    setting("a.far", 0, 1e6),
    setting("a.x", 0, 9),
  ];
  const varied = { name: "a.x", title: "the x", unit: "dm", low: 0.1, high: 0.5, factor: 10, offset: 0 };
  const system = { settings: settings.map((_, at) => [at, at, 2]) };
  const document = {
    settings,
    systems: [system],
    variables: [varied],
  } as unknown as SimulationDocument;
  const found = controlsOf(document, 0).map(({ setting: { name }, low, high }) => [name, low, high]);
  assert.deepEqual(found, [
    ["a.x", 0.1, 0.5],
    ["a.free", 0, 4],
    ["a.bounded", 0, 5],
    ["a.far", 0, 4],
  ]);
});

test("a plane is the next study, and what was moved besides is told", () => {
  const axis = (name: string, value: number) => ({ ...X, name, value, isMoved: true, isAxis: true });
  const text = simulatedStudy("gains", "bench", "12e345", [
    axis("a.x", 3),
    axis("a.y", 99),
    { ...X, name: "b.mass", unit: "kg", value: 2.5, isMoved: true, isAxis: false },
    { ...X, name: "b.same", value: 1, isMoved: false, isAxis: false },
  ]);
  assert.equal(
    text,
    `# simulated in the page of gains
# the parameters of bench were then, besides those below:
#   b.mass: 2.5 kg
study: gains_next
testbench: bench
configurations: ["12e345"]
design_variables:
  a.x: {range: [1 m, 25 m], levels: 25, nominal: 3 m}
  a.y: {range: [1 m, 25 m], levels: 25, nominal: 25 m}
sampler: full_factorial
`,
  );
});
