import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import cases from "../../../../tests/pair_cases.json";
import { boundChanges, decide, effectOf, type Missable, objectiveChanges } from "../src/decision";
import { groupingOf } from "../src/grouping";
import { aheadBy, aimsOf, orderAt } from "../src/order";
import { type Interval, leading } from "../src/pairs";
import type { Study } from "../src/study";
import { certaintyOf, changesOf, orderText } from "../src/views/pair/words";
import { resultOf } from "../src/views/sheet/results";
import { metric, near, requirement, storeOf, studyOf, variable } from "./study";

type Row = [string, number, number, number, number];
const ids = cases.configurations.map(([id]) => String(id));
const points = cases.points as [string, number, number, number][];
const runs = cases.runs as Row[];

/** The points, with the draws that they are made of. */
function paired(): Study {
  const place = (row: (string | number)[]): number =>
    points.findIndex((each) => [0, 1, 2].every((k) => each[k] === row[k]));
  const size = points.length;
  return studyOf(size, {
    configuration: Int32Array.from(points, ([id]) => ids.indexOf(id)),
    configurations: cases.configurations.map(([id, , noisy]) => ({
      id: String(id),
      choices: [["part", String(id)] as [string, string]],
      properties: [],
      picture: -1,
      parts: [],
      radial: null,
      noisy: Boolean(noisy),
      allocations: [],
    })),
    variables: [
      variable(
        "part.gain",
        points.map(([, gain]) => gain),
      ),
      variable(
        "world.speed",
        points.map(([, , speed]) => speed),
        { low: 10, high: 30, role: "condition", unit: "m/s" },
      ),
    ],
    metrics: [
      metric(
        "gap",
        points.map((row) => row[3]),
      ),
    ],
    requirements: [{ ...requirement(size, { atLeast: cases.at_least }), metIn: cases.met_in, draws: ratesOf(place) }],
    objectives: [{ column: "property.0", maximize: false }],
    properties: [
      {
        name: "cost",
        title: "cost",
        unit: "EUR",
        isPrice: true,
        values: Float64Array.from(cases.configurations, ([, cost]) => Number(cost)),
        text: String,
      },
    ],
    drawn: {
      row: Int32Array.from(runs, place),
      draw: Int32Array.from(runs, ([, , , draw]) => draw),
      judged: [new Uint8Array(runs.length).fill(1)],
      values: new Map([[0, Float64Array.from(runs, (row) => row[4])]]),
    },
  });
}

function ratesOf(place: (row: Row) => number) {
  const rates = points.map((_, point) => {
    const own = runs.filter((row) => place(row) === point);
    const met = own.filter((row) => row[4] >= cases.at_least).length;
    // The interval of draws that differ is Clopper and Pearson's, too.
    const interval = leading([
      { first: met, second: own.length - met, difference: { value: 0, low: Number(!own[0]![3]) - 1, high: 0 } },
    ]);
    return { met, judged: own.length, low: own[0]![3] ? interval.low : 1, high: own[0]![3] ? interval.high : 1 };
  });
  const column = (of: (rate: (typeof rates)[number]) => number): Float32Array => Float32Array.from(rates, of);
  return {
    met: column(({ met }) => met),
    judged: column(({ judged }) => judged),
    low: column(({ low }) => low),
    high: column(({ high }) => high),
  };
}

function same(found: Interval, wanted: (number | null)[]): void {
  const [value, low, high] = wanted.map((each) => each ?? NaN);
  ok(
    near(found.value, value!, 1e-9) && near(found.low, low!, 1e-9) && near(found.high, high!, 1e-9),
    JSON.stringify([found, wanted]),
  );
}

for (const wanted of cases.decisions) {
  test(`${wanted.first.join(" ")} against ${wanted.second.join(" ")} is decided as in Python`, () => {
    const study = paired();
    const store = storeOf(study);
    const grouping = groupingOf(study);
    const design = ([id, gain]: (string | number)[]): number =>
      grouping.of[points.findIndex((row) => row[0] === id && row[1] === gain)]!;
    const found = decide(
      study,
      store.state.thresholds,
      store.judgement(),
      aimsOf(study),
      orderAt(store),
      design(wanted.first),
      design(wanted.second),
    );
    deepEqual([found.missed, found.judged, found.ahead], [wanted.missed, wanted.judged, wanted.ahead]);
    deepEqual(found.objectives, [[wanted.objectives[0]![0], wanted.objectives[1]![0]]]);
    equal(found.cases.length, wanted.pairs.length);
    for (const [index, { counts, runs: pair }] of found.cases.entries()) {
      const expected = wanted.pairs[index]!;
      equal(study.variables[1]!.values[pair[0]], expected.speed);
      deepEqual(
        [counts.both, counts.first, counts.second, counts.neither],
        [expected.both, expected.first, expected.second, expected.neither],
      );
      ok(near(counts.margin, expected.margin, 1e-9) && near(counts.error, expected.error, 1e-9));
      same(counts.difference, expected.difference);
    }
    equal(found.leading[0] === null, wanted.leading === null);
    if (wanted.leading) same(found.leading[0]!, wanted.leading);
    equal(found.bounds.length, wanted.bounds.length);
    for (const [index, { shift, ahead }] of found.bounds.entries()) {
      const [by, then] = wanted.bounds[index]!;
      ok(near(shift, by!, 1e-9) && ahead === then);
    }
    deepEqual(
      found.changes.map(({ objective, change, ahead }) => [objective, change, ahead]),
      wanted.changes,
    );
    const effects = found.effects.map(({ variable, values }) => ({
      variable: study.variables[variable]!.name,
      values,
    }));
    const expected = wanted.effects.map(({ variable, values }) => ({ variable, values }));
    const byName = (a: { variable: string }, b: { variable: string }): number => (a.variable < b.variable ? -1 : 1);
    deepEqual(effects.sort(byName), expected.sort(byName));
    for (const { variable, levels, change } of found.effects) {
      const own = wanted.effects.find((each) => each.variable === study.variables[variable]!.name)!;
      for (const [index, level] of levels.entries()) same(level, own.levels[index]!);
      same(change, own.change);
    }
  });
}

test("bounds and objectives that change the order are those of Python", () => {
  for (const { first, second, doubtful, missed, tie, changes } of cases.bounds) {
    const sides = [first, second].map((own, side) => {
      const margins = own.map((each) => each ?? NaN);
      const misses = margins.flatMap((each, place) => (each < 0 ? [place] : [])).slice(0, doubtful[side]);
      return margins.map((each, place): Missable => [each, misses.includes(place)]);
    }) as [Missable[], Missable[]];
    const ties = [Number(tie < 0), Number(tie > 0)];
    const keys = missed.map((all, side) => [0, all - doubtful[side]!, doubtful[side]!, ties[side]!]);
    deepEqual(boundChanges(...sides, keys as [number[], number[]], 1), changes);
  }
  for (const { values, ahead, changes } of cases.objectives) {
    const pairs = values.map(([a, b]) => [a ?? Infinity, b ?? Infinity]) as [number, number][];
    equal(aheadBy(pairs, 0, 1)[0], ahead);
    deepEqual(objectiveChanges(pairs), changes);
  }
});

test("a straight line through many values is that of Python", () => {
  const { points: given, values, levels, change } = cases.line;
  const found = effectOf(given.map(([x, margin]) => [x!, { margin: margin!, error: 0 }]))!;
  ok(found.isLine);
  deepEqual(found.values, values);
  for (const [index, level] of found.levels.entries()) same(level, levels[index]!);
  same(found.change, change);
});

test("a sheet of requirements has the worst of all points, and the run that decides", () => {
  const study = paired();
  const store = storeOf(study);
  const grouping = groupingOf(study);
  // Design 0, at the three speeds: two points are missed.
  const found = resultOf(store, grouping, 0, 0);
  const gaps = points.slice(0, 3).map((row) => row[3]);
  const least = Math.min(...gaps);
  deepEqual(found.counts, [1, 2, 0, 0, 0]);
  deepEqual([found.mark, found.run, found.error], [1, gaps.indexOf(least), null]);
  ok(near(found.margin, least - cases.at_least, 1e-12));
  deepEqual(
    found.missing,
    [0, 1, 2].filter((run) => gaps[run]! < cases.at_least),
  );
  const nothing = studyOf(2, {
    ...study,
    requirements: [requirement(points.length, { atLeast: 2, exercised: points.map(() => 0) })],
  });
  equal(resultOf(storeOf({ ...nothing, size: study.size }), grouping, 0, 0).mark, 2);
});

test("a decision is told in plain sentences", () => {
  const study = paired();
  const store = storeOf(study);
  const { thresholds } = store.state;
  const [aims, order] = [aimsOf(study), orderAt(store)];
  // Designs are in the order of their first runs: a with gains 0 and 1, then b.
  const decision = decide(study, thresholds, store.judgement(), aims, order, 0, 2);
  equal(
    orderText(aims, order, decision, [0, 2]),
    "Both miss 2 of 3 verdicts. B is ahead: its cost is 200\u202fEUR, that of A 300\u202fEUR.",
  );
  equal(
    certaintyOf(study, decision),
    "In the same draws, the rates differ with 95\u202f% confidence in none of 3 verdicts: with other draws the order may differ.",
  );
  deepEqual(changesOf(study, thresholds, aims, order, decision), [
    "R: with at least 1.897 instead of 2, A is ahead.",
    "R: with more than 2.102 instead of 2, A is ahead.",
    "cost: if A\u2019s is lower by more than 100\u202fEUR, or B\u2019s higher by more than that, A is ahead.",
  ]);
});
