import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import designs from "../../../../tests/design_cases.json";
import rule from "../../../../tests/verdict_cases.json";
import { groupingOf } from "../src/grouping";
import { standingOf, tightened } from "../src/judgement";
import { conditionsInWords, pointsOf } from "../src/points";
import { drawsAt, errorOf, isDoubtful, judge, margin, tally } from "../src/verdicts";
import { aggregated } from "../src/views/designs/values";
import { leastMargin, marginWithShare, scaleOf, shareText } from "../src/views/shared/margins";
import { metric, near, requirement, storeOf, studyOf, variable } from "./study";

const WORDS = ["pass", "fail", "not exercised", "failed to run"];
const BOUNDS = rule.bounds.map(([atMost, atLeast]) => ({ atMost: atMost ?? null, atLeast: atLeast ?? null }));
const FLAGS = [true, false];
const CASES = rule.values.flatMap(({ value, verdicts }) =>
  FLAGS.flatMap((first) =>
    FLAGS.flatMap((second) =>
      FLAGS.flatMap((third) =>
        FLAGS.map((done) => ({ value: Number(value), verdicts, exercised: [first, second, third], done })),
      ),
    ),
  ),
);

test("every case of the verdict rule is judged as in Python", () => {
  const size = CASES.length;
  equal(size, 128);
  const values = CASES.map(({ value }) => value);
  const study = studyOf(size, {
    done: Uint8Array.from(CASES, ({ done }) => Number(done)),
    metrics: [metric("m", values)],
    requirements: BOUNDS.map(({ atMost, atLeast }, index) => ({
      ...requirement(size, { exercised: CASES.map(({ exercised }) => exercised[index]!) }),
      atMost,
      atLeast,
    })),
  });
  const { each, overall } = judge(study, BOUNDS);
  CASES.forEach(({ verdicts, exercised, done }, run) => {
    const wanted = verdicts.map((verdict, i) => (done ? (exercised[i] ? verdict : "not exercised") : "failed to run"));
    deepEqual(
      each.map((marks) => WORDS[marks[run]!]!),
      wanted,
    );
    const worst = ["failed to run", "fail", "not exercised", "pass"].find((word) => wanted.includes(word));
    equal(WORDS[overall[run]!], worst);
  });
});

test("margins are signed, and undefined where the metric is", () => {
  for (const { value, margins } of rule.values) {
    deepEqual(
      BOUNDS.map((bounds) => margin(Number(value), bounds)),
      margins.map(Number),
    );
  }
});

test("a requirement that is switched off counts only in its own verdict", () => {
  const study = studyOf(2, { metrics: [metric("m", [1, 3])], requirements: [requirement(2, { atMost: 2 })] });
  const { each, overall } = judge(study, [{ atMost: 2, atLeast: null, off: true }]);
  deepEqual([...each[0]!], [0, 1]);
  deepEqual([...overall], [0, 0]);
  deepEqual(tally(study, each[0]!, -1), [1, 1, 0, 0, 0]);
  deepEqual(tally(study, each[0]!, -1, [1]), [0, 1, 0, 0, 0]);
});

test("a verdict is doubtful if the error bar reaches the bound, and only where errors were checked", () => {
  const study = studyOf(5, {
    checked: Uint8Array.from([1, 1, 1, 1, 0]),
    metrics: [metric("m", [0.4, 0.4, NaN, NaN, 0.4], [0.12, 0.05, Infinity, 1, 0.12])],
    requirements: [requirement(5, { atMost: 0.5 })],
  });
  const at = { atMost: 0.5, atLeast: null };
  deepEqual([...judge(study, [at]).doubtful], [1, 0, 1, 0, 0]);
  deepEqual([...judge(study, [{ ...at, atMost: 0.6 }]).doubtful], [0, 0, 1, 0, 0]);
  equal(errorOf(study, 0, 4), null);
  const open = { ...study, requirements: [requirement(5, { atMost: 0.5, exercised: [0, 0, 0, 0, 0] })] };
  equal(isDoubtful(open, 0, 0, at), false);
  const unsettled = { ...open.requirements[0]!, unsettled: Uint8Array.from([0, 1, 0, 0, 0]) };
  deepEqual([...judge({ ...open, requirements: [unsettled] }, [at]).doubtful], [0, 1, 0, 0, 0]);
});

test("every case of the design rule is judged as in Python", () => {
  const runs = designs.designs.flatMap(({ runs }, design) => runs.map((run) => ({ design, run })));
  const size = runs.length;
  const values = runs.map(({ run }) => Number(run[2]));
  const study = studyOf(size, {
    done: Uint8Array.from(runs, ({ run }) => Number(run[4])),
    variables: [
      variable(
        "design",
        runs.map(({ design }) => design),
      ),
      variable(
        "condition",
        runs.map(({ run }) => Number(run[0])),
        { role: "condition" },
      ),
      variable(
        "draw",
        runs.map(({ run }) => Number(run[1])),
        { role: "uncertain" },
      ),
    ],
    metrics: [metric("use", values)],
    requirements: [requirement(size, { atMost: designs.at_most, exercised: runs.map(({ run }) => Boolean(run[3])) })],
  });
  const at = [{ atMost: designs.at_most, atLeast: null }];
  const { mark, margins, slack } = standingOf(study, at, 0, judge(study, at));
  const objective = aggregated(study, Float64Array.from(values), "min");
  designs.designs.forEach((design, index) => {
    equal(WORDS[mark[index]!], design.verdict, `design ${index}`);
    ok(near(margins[0]![index]!, Number(design.margin)), `margin of design ${index}`);
    const share = design.verdict === "failed to run" ? NaN : Number(design.margin) / designs.at_most;
    ok(near(slack[index]!, share), `least margin of design ${index}`);
    ok(near(objective[index]!, Number(design.objective)), `objective of design ${index}`);
  });
});

test("a condition at which no design has a value does not count", () => {
  const values = [NaN, 2, NaN, 3];
  const study = studyOf(4, {
    variables: [variable("design", [0, 0, 1, 1]), variable("condition", [0, 1, 0, 1], { role: "condition" })],
    metrics: [metric("use", values)],
  });
  for (const sense of ["min", "max", ""] as const)
    equal(Array.from(aggregated(study, Float64Array.from(values), sense)).join(), "2,3");
  const failed = { ...study, done: Uint8Array.from([0, 1, 1, 1]) };
  ok(Number.isNaN(aggregated(failed, Float64Array.from(values), "min")[0]));
});

test("margin that is asked for moves bounds inwards by its share of their scale", () => {
  const study = studyOf(4, {
    variables: [variable("x", [0, 1, 2, 3])],
    metrics: [metric("m", [0, 8, -2, 4])],
    requirements: [
      requirement(4, { atMost: 10 }),
      requirement(4, { atMost: 6, atLeast: 2 }),
      requirement(4, { atMost: 0 }),
    ],
  });
  const thresholds = study.requirements.map(({ atMost, atLeast }) => ({ atMost, atLeast }));
  // Of a bound its size, of a band half its width, of a bound at 0 the median size of the values that are not 0.
  deepEqual(
    thresholds.map((threshold, index) => scaleOf(study, index, threshold)),
    [10, 2, 4],
  );
  deepEqual(tightened(study, thresholds, 0.25), [
    { atMost: 7.5, atLeast: null },
    { atMost: 5.5, atLeast: 2.5 },
    { atMost: -1, atLeast: null },
  ]);
  equal(tightened(study, thresholds, 0), thresholds);
  const { each } = standingOf(study, thresholds, 0.25, judge(study, thresholds));
  deepEqual([...each[0]!], [0, 1, 0, 0]);
});

test("the least margin of a run is a share over requirements that count and were exercised", () => {
  const study = studyOf(2, {
    metrics: [metric("m", [8, NaN])],
    requirements: [
      requirement(2, { atMost: 10 }),
      requirement(2, { atMost: 9 }),
      requirement(2, { atMost: 1, exercised: [0, 1] }),
    ],
  });
  ok(near(leastMargin(storeOf(study), 0), 1 / 9));
  const off = study.requirements.map(({ atMost, atLeast }, index) => ({ atMost, atLeast, off: index === 1 }));
  ok(near(leastMargin(storeOf(study, { thresholds: off }), 0), 0.2));
  equal(leastMargin(storeOf(study), 1), NaN);
});

// y = 0.2 + load / 2 - gain is to be at most 0 at twelve gains k / 11, nine rates and two loads.
function pairs() {
  const rows = Array.from({ length: 216 }, (_, run) => [Math.floor(run / 18) / 11, (run >> 1) % 9, run % 2] as const);
  return studyOf(216, {
    sampler: "full_factorial",
    variables: [
      variable(
        "gain",
        rows.map(([gain]) => gain),
      ),
      variable(
        "rate",
        rows.map(([, rate]) => rate),
        { high: 8 },
      ),
      variable(
        "load",
        rows.map(([, , load]) => load),
        { role: "condition", unit: "kg" },
      ),
    ],
    metrics: [
      metric(
        "y",
        rows.map(([gain, , load]) => 0.2 + load / 2 - gain),
      ),
    ],
    requirements: [requirement(216, { atMost: 0 })],
  });
}

test("a design is judged at the worst of the conditions that are let through", () => {
  const study = pairs();
  const at = (load: number) => {
    const store = storeOf(study, { fixed: [0, 0, load] });
    const { noun, judgement, runs } = store.points();
    return { noun, counts: tally(study, judgement.overall, -1, runs), store };
  };
  // Empty pass the gains from 3 / 11 on, loaded those from 8 / 11 on.
  deepEqual([at(NaN).noun, at(NaN).counts], ["design", [36, 72, 0, 0, 0]]);
  deepEqual([at(0).noun, at(0).counts], ["design", [81, 27, 0, 0, 0]]);
  const worst = at(NaN).store;
  // A gain of 5 / 11: empty (run 90) passes, loaded decides.
  equal(worst.judgement().overall[90], 0);
  equal(worst.points().judgement.overall[90], 1);
  deepEqual([worst.points().first(91), worst.points().deciding(90)], [90, 91]);
  equal(conditionsInWords(study, worst.state), " at the worst of 2 conditions");
  equal(conditionsInWords(study, at(0).store.state), " at load 0\u202fkg");
  // With the condition on an axis each of its values is a point of its own.
  const axes = pointsOf(worst, { ...worst.state, x: 2, y: 0 });
  deepEqual([axes.noun, tally(study, axes.judgement.overall, -1, axes.runs)], ["point", [117, 99, 0, 0, 0]]);
});

test("a design that lacks a condition is undecided, and one that misses a bound there fails", () => {
  const study = studyOf(4, {
    variables: [
      variable("x", [0, 0, 1, 2], { high: 2 }),
      variable("z", [0, 0, 0, 0]),
      variable("load", [0, 1, 0, 1], { role: "condition" }),
    ],
    metrics: [metric("y", [0, 0, 0, 9])],
    requirements: [requirement(4, { atMost: 2 })],
  });
  const at = [{ atMost: 2, atLeast: null }];
  deepEqual([...standingOf(study, at, 0, judge(study, at)).mark], [0, 2, 1]);
  const failed = { ...study, done: Uint8Array.from([1, 0, 0, 1]) };
  const { mark, each, judged, certain, deciding } = standingOf(failed, at, 0, judge(failed, at));
  // Of the first design one run of two failed, of the second its only one.
  deepEqual(
    [[...mark], [...each[0]!]],
    [
      [3, 3, 1],
      [0, 3, 1],
    ],
  );
  deepEqual(
    [[...judged[0]!], [...certain[0]!], [...deciding]],
    [
      [2, 1, 1],
      [1, 1, 1],
      [1, 2, 3],
    ],
  );
  deepEqual([...groupingOf(study).whole], [1, 0, 0]);
});

test("draws that differ leave a verdict in doubt at the study's own bound, and say nothing of another one", () => {
  const draws = {
    met: Float32Array.of(20, 19, 10, 0),
    judged: Float32Array.of(20, 20, 20, 0),
    low: Float32Array.of(0.83, 0.75, 0.27, 0),
    high: Float32Array.of(1, 0.999, 0.73, 1),
  };
  const drawn = { ...requirement(4, { atMost: 1 }), draws };
  const study = studyOf(4, { metrics: [metric("m", [0.5, 0.9, 2, 0.5])], requirements: [drawn] });
  const own = { atMost: 1, atLeast: null };
  deepEqual([...judge(study, [own]).doubtful], [0, 1, 0, 0]);
  deepEqual([...judge(study, [{ ...own, atMost: 0.6 }]).doubtful], [0, 0, 0, 0]);
  equal(drawsAt(study, 0, 1, own)!.met, 19);
  equal(drawsAt(study, 0, 3, own), null);
});

test("a requirement that does not apply to a run is not counted", () => {
  const elsewhere = { ...requirement(2, { atMost: 1 }), applies: Uint8Array.of(0, 1) };
  const study = studyOf(2, { metrics: [metric("m", [5, 5])], requirements: [elsewhere] });
  const { each, overall } = judge(study, [{ atMost: 1, atLeast: null }]);
  deepEqual([...each[0]!], [4, 1]);
  deepEqual([...overall], [0, 1]);
  deepEqual(tally(study, each[0]!, -1), [0, 1, 0, 0, 1]);
});

test("a point is not judged by requirements of other benches", () => {
  const elsewhere = { ...requirement(4, { atMost: 1 }), applies: Uint8Array.of(0, 1, 0, 1) };
  const study = studyOf(4, {
    variables: [variable("x", [0, 0, 1, 1]), variable("testbench", [0, 1, 0, 1], { role: "condition" })],
    metrics: [metric("m", [5, 0, 5, 5])],
    requirements: [elsewhere, requirement(4, { atMost: 9 })],
  });
  const store = storeOf(study, { x: 0, y: 1 });
  const { noun, judgement } = store.points();
  deepEqual([noun, [...judgement.overall]], ["point", [0, 0, 0, 1]]);
  deepEqual([...judgement.each[0]!], [4, 0, 4, 1]);
  // Over both benches it is a requirement of the design.
  deepEqual([...store.designs().judgement.each[0]!], [0, 0, 1, 1]);
});

test("a margin has its share in brackets, but none of a bound at 0", () => {
  const study = studyOf(2, {
    metrics: [metric("speed", [-3, 0])],
    requirements: [requirement(2, { atMost: 0 })],
  });
  const at = (atMost: number | null, atLeast: number | null) => ({ atMost, atLeast, off: false });
  equal(marginWithShare(study, 0, at(0, null), 3), "3");
  equal(marginWithShare(study, 0, at(null, 0), 3), "3");
  equal(marginWithShare(study, 0, at(12, null), 3), "3 (25\u202f%)");
  equal(marginWithShare(study, 0, at(6, 0), 3), "3 (100\u202f%)");
  // Compared with others, it is a share of the median size.
  equal(shareText(leastMargin(storeOf(study), 0)), "100\u202f%");
});
