import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import cases from "../../../../tests/order_cases.json";
import { groupingOf } from "../src/grouping";
import { missedText, orderAt } from "../src/order";
import type { Store } from "../src/store";
import type { Requirement } from "../src/study";
import { createModel } from "../src/views/designs/model";
import { choiceOf } from "../src/views/overview/choice";
import { metric, near, requirement, storeOf, studyOf, variable } from "./study";

type Point = [string, number, number, number, number | null, [number, number, number, number][]];
type Run = [string, number, number, number, number | null];
interface Designs {
  designs: string;
  objectives: (string | boolean)[][];
  choices?: Record<string, Record<string, string>> | undefined;
}
const LEVELS: Record<string, number> = { Critical: 0, major: 1, "": 2 };

/** The designs of a case. */
function studied({ designs, objectives, choices }: Designs): Store {
  const own = cases.configurations.filter(([id]) => designs.includes(String(id)));
  const ids = own.map(([id]) => String(id));
  const points = (cases.points as unknown as Point[]).filter(([id]) => ids.includes(id));
  const runs = (cases.runs as Run[]).filter(([id]) => ids.includes(id));
  const place = ([id, speed]: Run): number => points.findIndex((point) => point[0] === id && point[1] === speed);
  const size = points.length;
  const numbers = points.map(([, , lead]) => {
    const [id, speed, draw] = (cases.runs as Run[])[lead]!;
    return runs.findIndex((row) => row[0] === id && row[1] === speed && row[2] === draw);
  });
  const study = studyOf(size, {
    number: Int32Array.from(numbers),
    configuration: Int32Array.from(points, ([id]) => ids.indexOf(id)),
    configurations: own.map(([id, , noisy]) => ({
      id: String(id),
      choices: Object.entries(choices?.[String(id)] ?? { part: String(id) }),
      properties: [],
      picture: -1,
      parts: [],
      radial: null,
      noisy: Boolean(noisy),
      allocations: [],
    })),
    variables: [
      variable(
        "speed",
        points.map(([, speed]) => speed),
        { role: "condition", unit: "m/s", text: String },
      ),
    ],
    metrics: [
      metric(
        "gap",
        points.map((row) => row[3]),
      ),
      metric(
        "peak",
        points.map((row) => row[4] ?? NaN),
      ),
    ].map((column) => ({ ...column, text: String })),
    requirements: cases.requirements.map(([name, title, of, bounds, severity], index): Requirement => {
      const { at_least: atLeast, at_most: atMost } = bounds as { at_least?: number; at_most?: number };
      const rates = points.map((row) => row[5][index]!);
      const column = (k: number): Float32Array => Float32Array.from(rates, (rate) => rate[k]!);
      return {
        ...requirement(size, {
          metric: of === "gap" ? 0 : 1,
          exercised: points.map((row) => of === "gap" || row[4] !== null),
          ...(atLeast ? { atLeast } : { atMost: atMost! }),
        }),
        name: String(name),
        title: String(title),
        metIn: cases.met_in,
        level: LEVELS[String(severity)]!,
        origin: severity ? [["severity", String(severity)]] : [],
        draws: { met: column(0), judged: column(1), low: column(2), high: column(3) },
      };
    }),
    properties: [
      {
        name: "cost",
        title: "cost",
        unit: "EUR",
        isPrice: true,
        values: Float64Array.from(own, ([, cost]) => Number(cost)),
        text: String,
      },
    ],
    objectives: objectives.map(([name, maximize]) => ({
      column: name === "cost" ? "property.0" : name === "gap" ? "metric.0" : "metric.1",
      maximize: Boolean(maximize),
    })),
    drawn: {
      row: Int32Array.from(runs, place),
      draw: Int32Array.from(runs, ([, , draw]) => draw),
      judged: cases.requirements.map(([, , of]) =>
        Uint8Array.from(runs, (row) => Number(of === "gap" || row[4] !== null)),
      ),
      values: new Map([
        [0, Float64Array.from(runs, (row) => row[3])],
        [1, Float64Array.from(runs, (row) => row[4] ?? NaN)],
      ]),
    },
  });
  return storeOf(study);
}

const plain = (text: string): string => text.replaceAll("\u202f", " ").replaceAll("\u2212", "-");

for (const wanted of cases.cases) {
  test(`designs ${wanted.designs} by ${JSON.stringify(wanted.objectives)} are in the order of Python`, () => {
    const store = studied(wanted);
    const { study } = store;
    const { first } = groupingOf(study);
    const id = (design: number): string => study.configurations[study.configuration[first[design]!]!]!.id;
    const { ranked, keys, place } = orderAt(store);
    equal(Array.from(ranked, id).join(""), wanted.order);
    for (const design of ranked) {
      equal(ranked[place[design]!], design);
      const key = (wanted.keys as Record<string, number[]>)[id(design)]!;
      equal(keys.length, key.length);
      ok(key.every((value, column) => near(keys[column]![design]!, value, 1e-9)));
    }
  });

  test(`of designs ${wanted.designs} by ${JSON.stringify(wanted.objectives)} the terminal names the same one`, () => {
    const { name, lines } = choiceOf(createModel(studied(wanted)))!;
    deepEqual({ name: plain(name), lines: lines.map((line) => line.map(plain)) }, wanted.choice);
  });
}

test("a requirement that is switched off does not count in the order", () => {
  const store = studied({ designs: "de", objectives: [] });
  const off = store.state.thresholds.map((threshold, index) => ({ ...threshold, off: index === 1 }));
  store.set({ thresholds: off });
  const { ranked, classes } = orderAt(store);
  deepEqual([...ranked], [1, 0]);
  deepEqual(
    classes.map(({ severity }) => severity),
    ["major", ""],
  );
  equal(missedText(orderAt(store), 0), "1 of 2 major");
  equal(missedText(orderAt(store), 1), "none");
});

test("doubtful verdicts are named as such beside the missed ones", () => {
  const told = cases.cases.flatMap((wanted) => {
    const order = orderAt(studied(wanted));
    return [...order.ranked].map((design): [string, boolean] => [
      missedText(order, design),
      order.classes.some(({ doubtful }) => doubtful[design]! > 0),
    ]);
  });
  ok(told.some(([, isDoubtful]) => isDoubtful));
  for (const [text, isDoubtful] of told) equal(text.includes("doubtful"), isDoubtful);
});

test("a bound that is moved gives another design", () => {
  const store = studied({ designs: "ab", objectives: [["cost", false]] });
  equal(choiceOf(createModel(store))!.first, 1);
  store.set({ thresholds: store.state.thresholds.map((each, index) => (index ? each : { ...each, atLeast: 2.4 })) });
  const { first, lines } = choiceOf(createModel(store))!;
  equal(first, 0);
  equal(plain(lines[0]![1]), "It meets all 3 requirements in both conditions: 6 verdicts. 1 of 2 designs do.");
});
