import { deepEqual, equal } from "node:assert/strict";
import test from "node:test";
import { loadsOf } from "../src/views/shared/allocation";

const ALLOCATION = {
  place: "placement",
  hosts: ["computer_1", "computer_2"],
  functions: ["brake", "steering"],
  on: { brake: ["computer_1", "computer_2"], steering: ["computer_2"] },
  loads: [
    {
      load: "compute",
      capacity: "power",
      unit: "TOPS",
      loads: { brake: 2, steering: 3 },
      capacities: { computer_1: 4, computer_2: 20 },
    },
    {
      load: "mass",
      capacity: "mass",
      unit: "",
      loads: { brake: 1, steering: 1 },
      capacities: { computer_1: 0, computer_2: 8 },
    },
  ],
};
const plain = (text: string): string => text.replaceAll(/[\u202f\u00a0]/g, " ");

test("a host carries the load of all functions it executes", () => {
  const [compute, mass] = loadsOf(ALLOCATION);
  equal(compute![0], "sum of compute, of power");
  deepEqual(compute![1].map(plain), ["2 of 4 TOPS (50 %)", "5 of 20 TOPS (25 %)"]);
  equal(mass![0], "sum of mass");
});

test("of no capacity there is no share", () => {
  deepEqual(loadsOf(ALLOCATION)[1]![1].map(plain), ["1 of 0", "2 of 8 (25 %)"]);
});

test("an allocation without loads has no sums", () => {
  deepEqual(loadsOf({ ...ALLOCATION, loads: [] }), []);
});
