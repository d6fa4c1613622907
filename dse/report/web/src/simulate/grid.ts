// The plane through the point that is simulated: runs on a grid, the coarse ones first, as a study for the plot.
import { columnText } from "../format";
import { FAILED, NOT_APPLICABLE, NOT_EXERCISED } from "../marks";
import type { Metric, Study, Variable } from "../study";
import type { Ran } from "./engine";

/** Levels of each axis; with every second, and every fourth of them, there are the coarser grids. */
export const LEVELS = 25;
const STRIDES = [4, 2, 1];

/** Which nodes (row by row) are simulated one after the other, and after how many of them a grid is complete. */
export interface Order {
  nodes: number[];
  stages: { size: number; stride: number }[];
}

export function coarseFirst(): Order {
  const nodes = new Set<number>();
  const stages = STRIDES.map((stride) => {
    for (let row = 0; row < LEVELS; row += stride)
      for (let column = 0; column < LEVELS; column += stride) nodes.add(row * LEVELS + column);
    return { size: nodes.size, stride };
  });
  return { nodes: [...nodes], stages };
}

export interface Axis {
  name: string;
  title: string;
  unit: string;
  low: number;
  high: number;
}

export function valueAt({ low, high }: Axis, level: number): number {
  return low + ((high - low) * level) / (LEVELS - 1);
}

/** The runs of every *stride*-th level; metrics, requirements and titles are those of *study*. */
export function gridStudy(study: Study, [x, y]: [Axis, Axis], runs: (Ran | null)[], stride: number): Study {
  const levels = Array.from({ length: (LEVELS - 1) / stride + 1 }, (_, level) => level * stride);
  const nodes = levels.flatMap((row) => levels.map((column) => row * LEVELS + column));
  const made = nodes.map((node) => runs[node]!);
  const size = nodes.length;
  const variable = (axis: Axis, level: (node: number) => number): Variable => {
    const values = Float64Array.from(nodes, (node) => valueAt(axis, level(node)));
    const nothing = { labels: [], apart: [], lack: [], log: false, role: "design" as const };
    return { ...axis, ...nothing, values, text: columnText(values), nominal: axis.low, levels: 0 };
  };
  return {
    ...study,
    sampler: "full_factorial",
    size,
    number: Int32Array.from(nodes.keys()),
    configuration: new Int32Array(size),
    done: Uint8Array.from(made, ({ problem }) => Number(!problem)),
    checked: null,
    problems: new Map(made.flatMap(({ problem }, run) => (problem ? [[run, problem]] : []))),
    variables: [variable(x, (node) => node % LEVELS), variable(y, (node) => Math.floor(node / LEVELS))],
    metrics: study.metrics.map((metric, at): Metric => {
      const values = Float64Array.from(made, ({ metrics }) => metrics[at]!);
      return { ...metric, values, text: columnText(values), error: null };
    }),
    requirements: study.requirements.map((requirement, at) => ({
      ...requirement,
      exercised: Uint8Array.from(made, ({ marks }) => Number(marks[at] !== NOT_EXERCISED && marks[at] !== FAILED)),
      applies: Uint8Array.from(made, ({ marks }) => Number(marks[at] !== NOT_APPLICABLE)),
      unsettled: null,
      draws: null,
    })),
    configurations: [{ ...study.configurations[0]!, radial: null }],
    slices: [],
    figures: [],
    charted: [],
    scenes: null,
    drawn: null,
  };
}
