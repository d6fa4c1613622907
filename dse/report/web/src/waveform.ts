// One run's waveform out of the 16-bit steps written by dse/report/page/encoding.py.
import type { Numbers } from "./packing";
import type { Figure } from "./study";

const STEPS = 65534;
const MISSING = 65535;

/** Values over time, null where there is none; null if the figure has no such line. */
export function decode(
  figure: Figure,
  index: number,
  run: number,
  line: "current" | "target",
  blocks: Map<string, Numbers>,
): (number | null)[] | Float64Array | null {
  const row = figure.row.get(run);
  if (row === undefined) return null;
  const size = figure.time.length;
  if (line === "target" && figure.constants) return new Float64Array(size).fill(figure.constants[row]!);
  const ranges = figure.ranges[line];
  const codes = blocks.get(`figure.${index}.${line}`) as Uint16Array | undefined;
  if (!ranges || !codes) return null;
  const low = ranges.low[row]!;
  const span = ranges.high[row]! - low;
  const values: (number | null)[] = new Array(size);
  let step = 0;
  let code = 0;
  for (let i = 0; i < size; i++) {
    const packed = codes[row * size + i]!;
    step = (step + ((packed >> 1) ^ -(packed & 1))) & 0xffff;
    code = (code + step) & 0xffff;
    values[i] = code === MISSING ? null : low + span * (code / STEPS);
  }
  return values;
}
