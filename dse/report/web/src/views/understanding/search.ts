// How a search for the best designs went: what it had after each part of its runs.
import type { Chart } from "../../chart";
import { el } from "../../dom";
import { count, group, number, withUnit } from "../../format";
import type { Search } from "../../insight";
import { paintChart } from "../../plot/chart";
import type { Store } from "../../store";
import { palette } from "../../theme";
import { aimOf } from "../shared/aims";
import { createPainted } from "../shared/canvas";

export function createSearch(store: Store, search: Search): HTMLElement {
  const { objectives, units, stages, picks, designs, feasible, unfinished } = search;
  const several = objectives.length > 1;
  const known = stages.filter(({ volume, best }) => (several ? volume : best) !== null);
  const said = [
    `${group(feasible)} of ${count(designs, "design")} meet all requirements under all conditions they were run at`,
    several
      ? `${picks.length} of them are on the front of ${objectives.join(" and ")}`
      : `the best has ${aimOf(objectives[0]!)} ${picks.length ? withUnit(number(picks[0]!.values[0]!, 4), units[0]!) : "none"}`,
    ...(unfinished ? [`${count(unfinished, "design")} lack runs and count neither way`] : []),
  ];
  const text = el("p", { class: "sentence", id: "search" }, `${said.join("; ")}.`);
  if (!known.length || !feasible)
    return el(
      "div",
      {},
      text,
      el(
        "p",
        { class: "hint" },
        "No convergence can be drawn: no design is feasible, or all feasible ones are equal in an objective.",
      ),
    );
  const values = known.map(({ volume, best }) => (several ? 100 * volume! : best!));
  const [low, high] = several ? [0, 105] : [Math.min(...values), Math.max(...values)];
  const rim = several ? 0 : 0.08 * (high - low) || 1;
  const at = Float64Array.from(known, ({ runs }) => runs);
  const chart: Chart = {
    name: "search",
    title: "",
    note: "",
    x: { title: "study after", unit: "runs", log: false, low: 0, high: stages.at(-1)!.runs, names: [] },
    y: {
      title: several ? "volume the front dominates" : aimOf(objectives[0]!),
      unit: several ? "%" : units[0]!,
      log: false,
      low: low - rim,
      high: high + rim,
      names: [],
    },
    drawn: [
      { kind: "steps", label: "", x: at, y: Float64Array.from(values) },
      {
        kind: "points",
        label: "",
        verdict: null,
        x: at,
        y: Float64Array.from(values),
        runs: new Int32Array(at.length),
      },
    ],
  };
  const label = `${chart.y.title} after so many runs: ${known.map(({ runs }, index) => `${number(values[index]!, 3)} after ${runs}`).join(", ")}`;
  const what = several
    ? "As a share of what all designs of the study dominate at its end, up to the worst feasible value of each objective."
    : "The best feasible value so far.";
  const since = known[values.findIndex((value) => Math.abs(value - values.at(-1)!) <= 1e-9 * Math.abs(value))]!.runs;
  const hint =
    since === stages.at(-1)!.runs
      ? `${what} It still changed at the end: more runs would probably find more.`
      : `${what} It has not changed since run ${group(since)}.`;
  return el(
    "div",
    {},
    text,
    createPainted(store, "mini wide-mini", label, (sheet) => paintChart(sheet, chart, palette())).element,
    el("p", { class: "hint" }, hint),
  );
}
