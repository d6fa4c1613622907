// What dse/report/scene/html.py wrote: a document and columns over time.
import { unpack, type Entry, type Numbers } from "../packing";

export interface Strip {
  left: number[];
  right: number[];
  isDriven: boolean;
  isInside: boolean;
}

/** A traffic light beside the lanes of those who drive towards `heading`; `told` is its column, -1 for none. */
export interface Light {
  place: [number, number, number];
  heading: number;
  /** The line to stop at: x, y, z of both ends. */
  line: number[];
  told: number;
}

export interface Document {
  title: string;
  subtitle: string;
  steps: number;
  step: number;
  classes: string[];
  strips: Strip[];
  areas: [number[], number][];
  colours: string[];
  lights: Light[];
  host: { length: number; width: number; front: number };
  others: number;
  sensors: { name: string; title: string; mount: number; reach: number; angle: number; returns: number }[];
  instruments: { title: string; unit: string; items: string[]; hasTarget: boolean }[];
  columns: Entry[];
}

export interface Recording {
  document: Document;
  seconds: number;
  /** A column's value at a moment, straight between two frames. */
  at(name: string, time: number): number;
  /** The same for an angle, the short way round. */
  angle(name: string, time: number): number;
  /** The last frame's value: for numbers that stand for something. */
  held(name: string, time: number): number;
  column(name: string): Numbers | undefined;
}

export async function readRecording(): Promise<Recording> {
  const text = (id: string): string => document.getElementById(id)!.textContent!;
  const read = JSON.parse(text("document")) as Document;
  const columns = await unpack(read.columns, text("columns"));
  const last = read.steps - 1;
  const step = read.step || 1;
  const place = (time: number): [number, number] => {
    const exact = Math.min(Math.max(time / step, 0), last);
    const frame = Math.min(Math.floor(exact), Math.max(last - 1, 0));
    return [frame, exact - frame];
  };
  const between = (name: string, time: number, wrap: boolean): number => {
    const values = columns.get(name);
    if (!values) return 0;
    const [frame, share] = place(time);
    const start = values[frame]!;
    let change = (values[frame + 1] ?? start) - start;
    if (wrap) change -= 2 * Math.PI * Math.round(change / (2 * Math.PI));
    return start + share * change;
  };
  return {
    document: read,
    seconds: last * step,
    at: (name, time) => between(name, time, false),
    angle: (name, time) => between(name, time, true),
    held: (name, time) => columns.get(name)?.[Math.min(Math.floor(time / step + 1e-6), last)] ?? 0,
    column: (name) => columns.get(name),
  };
}
