import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import type { FactorAxis, Part, Profile } from "../src/insight";
import { levelAt, levelOf, placeAt, placesOf, placeText, valueAt } from "../src/views/shared/places";
import { featuresOf, predict } from "../src/views/understanding/formula";
import { near, studyOf, variable } from "./study";

const BASE = { unit: "m", label: "", is_condition: false, labels: [], levels: [], values: [] };
// Even places are uneven values: a half of the places is between 0 and 1, the other one between 1 and 10.
const GAIN: FactorAxis = { ...BASE, title: "gain", variable: 0, values: [0, 1, 10] };
const LEVELS = ["camera", "lidar", "radar"];
const SENSOR: FactorAxis = { ...BASE, title: "sensor", variable: -1, levels: LEVELS, labels: LEVELS };

test("values and places of a factor are each other's inverse", () => {
  deepEqual(
    [0, 0.25, 0.5, 0.75, 1].map((place) => valueAt(GAIN, place)),
    [0, 0.5, 1, 5.5, 10],
  );
  for (const place of [0, 0.1, 0.5, 0.9, 1]) ok(near(placeAt(GAIN, valueAt(GAIN, place)), place));
  deepEqual([placeAt(GAIN, -1), placeAt(GAIN, 11)], [0, 1]);
  // Of a variable that has certain values only, many places are one value: the middle of them.
  equal(placeAt({ ...GAIN, values: [0, 2, 2, 2, 4] }, 2), 0.5);
});

test("a choice has a place for each level", () => {
  deepEqual(
    [0, 0.34, 0.99, 1].map((place) => levelAt(SENSOR, place)),
    [0, 1, 2, 2],
  );
  equal(placeText(SENSOR, 0.5), "lidar");
  equal(placeText(GAIN, 0.75), "5.5\u202fm");
});

test("a run has the places of its values and choices", () => {
  const configuration = (sensor: string) => ({
    id: sensor,
    choices: [["sensor", sensor]] as [string, string][],
    properties: [],
    picture: -1,
    parts: [],
    radial: null,
    noisy: false,
    allocations: [],
  });
  const study = studyOf(2, {
    configuration: Int32Array.from([0, 1]),
    configurations: [configuration("radar"), configuration("sonar")],
    variables: [variable("gain", [5.5, 1], { high: 10, nominal: 0.5 })],
  });
  deepEqual(placesOf(study, [GAIN, SENSOR], 0), [0.75, 2.5 / 3]);
  // Of no run the nominal value and the first level; so is a level that the formula does not know.
  deepEqual(placesOf(study, [GAIN, SENSOR], -1), [0.25, 0.5 / 3]);
  equal(placesOf(study, [GAIN, SENSOR], 1)[1], 0.5 / 3);
  equal(levelOf(study, { ...SENSOR, title: "brake" }, 0), "absent");
});

test("a formula is a plane and powers of the distances to its centres", () => {
  deepEqual(featuresOf([GAIN, SENSOR], [0.75, 0.99]), [0.5, 0, 1]);
  const part = {
    factors: [GAIN, SENSOR],
    centres: [Float32Array.from([0.5, 0, 1, -0.5, 0, 1])],
  } as unknown as Part;
  // 10 of the first centre, 2 of the second, which is 1 away; 3, and 4, 5 and 6 by feature.
  const weights = Float32Array.from([10, 2, 3, 4, 5, 6]);
  const profile = { power: 1, centres: 0, weights } as Profile;
  equal(predict(part, profile, [0.75, 0.99]), 2 + 3 + 4 * 0.5 + 6);
  // At a place of 0 the distances are 1.5 and 0.5, cubed.
  equal(predict(part, { ...profile, power: 3 }, [0, 0.99]), 10 * 3.375 + 2 * 0.125 + 3 - 4 + 6);
});
