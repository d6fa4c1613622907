// Charts as dse/report/charts/chart.py describes them: two axes and what is drawn between them.
import { shortened } from "./format";
import type { Mark } from "./marks";
import type { Numbers } from "./packing";

export interface ChartAxis {
  title: string;
  unit: string;
  log: boolean;
  low: number;
  high: number;
  /** Of the positions 0, 1, … on an axis that has no numbers. */
  names: string[];
}

interface Curve {
  kind: "line" | "steps";
  label: string;
  x: Float64Array;
  y: Float64Array;
  /** Where it has a look of its own. */
  look?: { colour: string; width: number; dash: number[] };
}

interface Points {
  kind: "points";
  label: string;
  verdict: Mark | null;
  x: Float64Array;
  y: Float64Array;
  /** Numbers of the runs, not their positions. */
  runs: Int32Array;
}

interface Bars {
  kind: "bars";
  label: string;
  edges: Float64Array;
  heights: Float64Array;
}

interface Band {
  kind: "band";
  label: string;
  x: Float64Array;
  low: Float64Array;
  high: Float64Array;
}

interface Rule {
  kind: "rule";
  label: string;
  axis: "x" | "y";
  value: number;
}

export type Drawn = Curve | Points | Bars | Band | Rule;

export interface Chart {
  name: string;
  title: string;
  note: string;
  x: ChartAxis;
  y: ChartAxis;
  drawn: Drawn[];
}

/** A figure of the study: its charts, or why there are none. */
export interface Charted {
  title: string;
  problem: string;
  charts: Chart[];
}

const ARRAYS: Record<Drawn["kind"], string[]> = {
  line: ["x", "y"],
  steps: ["x", "y"],
  points: ["x", "y", "runs"],
  bars: ["edges", "heights"],
  band: ["x", "low", "high"],
  rule: [],
};

const MOST_TITLE = 120;
const MOST_NOTE = 1200;
const MOST_UNIT = 20;

function named(axis: ChartAxis): ChartAxis {
  return {
    ...axis,
    title: shortened(axis.title, MOST_TITLE),
    unit: shortened(axis.unit, MOST_UNIT),
    names: axis.names.map((name) => shortened(name, MOST_TITLE)),
  };
}

/** The figures of the document, with the arrays that lie beside it. */
export function readCharted(source: Charted[], arrays: Map<string, Numbers>): Charted[] {
  return source.map((figure, f) => ({
    ...figure,
    title: shortened(figure.title, MOST_TITLE),
    charts: figure.charts.map((chart, c) => ({
      ...chart,
      title: shortened(chart.title, MOST_TITLE),
      note: shortened(chart.note, MOST_NOTE),
      x: named(chart.x),
      y: named(chart.y),
      drawn: chart.drawn.map((drawn, d) => ({
        ...drawn,
        label: shortened(drawn.label, MOST_TITLE),
        ...Object.fromEntries(ARRAYS[drawn.kind].map((name) => [name, arrays.get(`chart.${f}.${c}.${d}.${name}`)])),
      })),
    })),
  }));
}
