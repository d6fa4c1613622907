import { deepEqual, equal } from "node:assert/strict";
import test from "node:test";
import { checked, columnText, count, group, number, percent, shortened, straight, withUnit } from "../src/format";
import { nextStudy, yamlOf } from "../src/yaml";
import { storeOf, studyOf, variable } from "./study";

test("numbers have a true minus sign and no more digits than asked for", () => {
  const shown: [number, number, string][] = [
    [0, 4, "0"],
    [-1.23456, 4, "\u22121.235"],
    [0.00012345, 3, "0.000123"],
    [0.00001, 4, "1e\u22125"],
    [12345.6, 4, "12346"],
    [1.234e7, 4, "1.234e7"],
    [1.2e7, 4, "1.2e7"],
    [2e9, 1, "2e9"],
    [NaN, 4, "undefined"],
    [Infinity, 4, "\u221e"],
    [-Infinity, 4, "\u2212\u221e"],
  ];
  for (const [value, digits, text] of shown) equal(number(value, digits), text);
});

test("all values of a column have the same decimals", () => {
  const text = columnText(Float64Array.from([1, 12.5, NaN]));
  deepEqual([1, 12.5, -3].map(text), ["1.00", "12.50", "\u22123.00"]);
  equal(text(NaN), "undefined");
  // A small value beside a bound must not look like zero.
  equal(text(0.0004), "0.0004");
  equal(columnText(Float64Array.from([1, 40]))(7), "7");
  equal(columnText(Float64Array.from([2e6]))(1.5), "1.5");
});

test("a value is shown to the last digit of its error bar", () => {
  const text = (): string => "40.01";
  const shown: [number, number | null, string][] = [
    [40.00512, 0.00022, "40.00512 \u00b1\u202f0.00022"],
    [40.00512, 0, "40.01 \u00b1\u202f0"],
    [40.00512, Infinity, "40.01 \u00b1\u202f\u221e"],
    [40.00512, NaN, "40.01 \u00b1\u202f?"],
    [40.00512, null, "40.01"],
    [40.00512, 123.4, "40.00512 \u00b1\u202f123"],
    [-40.00512, 0.21, "\u221240.01 \u00b1\u202f0.21"],
    // Below ten digits of the value a bar is rounding.
    [40.00512, 1e-12, "40.00512 \u00b1\u202f1e\u221212"],
    [NaN, 0.1, "40.01"],
  ];
  for (const [value, error, wanted] of shown) equal(checked(value, error, text), wanted);
});

test("names are cut by letters, and nothing turns around the text after them", () => {
  equal(shortened("\u202eabc\u2066", 5), "abc");
  equal(shortened("abcdef", 4), "abc\u2026");
  equal(shortened("ab cdef", 4), "ab\u2026");
  equal(shortened("\u{1f697}\u{1f697}\u{1f697}", 2), "\u{1f697}\u2026");
  equal(straight("a\u200fb"), "ab");
});

test("shares are never rounded to none or all", () => {
  const shown: [number, number, string][] = [
    [0, 0, "0"],
    [0, 9, "0.0"],
    [1, 2000, "<0.1"],
    [1999, 2000, ">99.9"],
    [1, 3, "33"],
    [1, 30, "3.3"],
    [99, 100, "99.0"],
    [5, 5, "100"],
  ];
  for (const [part, whole, text] of shown) equal(percent(part, whole), `${text}\u202f%`);
});

test("counts are grouped by thousands and have their plural", () => {
  equal(count(1, "run"), "1 run");
  equal(count(0, "run"), "0 runs");
  equal(count(1234567, "run"), "1\u202f234\u202f567 runs");
  equal(group(999), "999");
  deepEqual([withUnit("5", "m"), withUnit("5", "")], ["5\u202fm", "5"]);
});

function gains(id = "c4f1a2") {
  return studyOf(3, {
    title: "Gains\nof two lines",
    configurations: [
      { id, choices: [], properties: [], picture: -1, parts: [], radial: null, noisy: false, allocations: [] },
    ],
    variables: [
      variable("controller.kp", [0.1, 0.30000000000000004, 1e-7], { unit: "1/s", high: 3, nominal: 1.2 }),
      variable("controller.kd", [0, -2, 5], { low: -2, high: 5 }),
      variable("road grip", [1, 1, 0], { role: "condition" }),
      variable("absent", [1, 2, 3], { lack: [0] }),
    ],
  });
}

test("a run's parameters are YAML with all digits", () => {
  equal(
    yamlOf(gains(), 1),
    [
      "# run 1 of Gains of two lines",
      "configuration: c4f1a2",
      "parameters:",
      "  controller.kp: 0.30000000000000004 1/s",
      "  controller.kd: -2",
      "  road grip: 1",
      "",
    ].join("\n"),
  );
  equal(yamlOf(gains(), 2).split("\n")[3], "  controller.kp: 1e-7 1/s");
});

test("what YAML would read as something else than a text is quoted", () => {
  // 16 digits of a hash are a float to YAML 1.2 if they have one e and else decimals.
  for (const id of [
    "123",
    "1.5",
    "12e345",
    "1_000",
    "0x1f",
    "+1",
    ".5",
    "true",
    "No",
    "null",
    "~",
    "-x",
    "a: b",
    "x ",
  ]) {
    equal(yamlOf(gains(id), 0).split("\n")[1], `configuration: ${JSON.stringify(id)}`);
  }
  for (const id of ["c4f1a2", "e5", "disc brake", "radar_77ghz"])
    equal(yamlOf(gains(id), 0).split("\n")[1], `configuration: ${id}`);
  equal(yamlOf(gains('</script>\n"'), 0).split("\n")[1], 'configuration: "</script>\\n\\""');
});

test("the next study has the brushed ranges, else the reach of the runs within, and no conditions", () => {
  const lines = (brushes: { column: string; low: number; high: number }[]) =>
    nextStudy(storeOf(gains(), { brushes }))
      .split("\n")
      .filter((line) => /range|nominal|^ {2}\S/.test(line))
      .map((line) => line.trim());
  const absent = ["absent:", "range: [0, 1]", "nominal: 0"];
  deepEqual(lines([]), [
    "controller.kp:",
    "range: [0 1/s, 3 1/s]",
    "nominal: 1.2 1/s",
    "controller.kd:",
    "range: [-2, 5]",
    "nominal: 0",
    ...absent,
  ]);
  // Ends are rounded to six digits and kept in the range; the nominal value follows. Within are the first two runs.
  const brushed = lines([{ column: "variable.0", low: 0.09999999, high: 0.7 }]);
  deepEqual(brushed.slice(1, 6), [
    "range: [0.1 1/s, 0.7 1/s]",
    "nominal: 0.7 1/s",
    "controller.kd:",
    "range: [-2, 0]",
    "nominal: 0",
  ]);
});
