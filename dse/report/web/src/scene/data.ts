// What a scene is drawn from: a recorded run, or one that is being driven (stream.ts).
import { type Entry, unpack } from "../packing";

export interface Strip {
  left: number[];
  right: number[];
  isDriven: boolean;
  isInside: boolean;
  /** The lane's type in OpenDRIVE. */
  kind: string;
}

/** A marking along `line` (x, y, z of each point); kind and colour are OpenDRIVE's words. */
export interface Marking {
  line: number[];
  kind: string;
  width: number;
  colour: string;
}

/** A sign for those who drive towards `heading`: "limit" with its number as `text`, or a German code. */
export interface Sign {
  place: [number, number, number];
  heading: number;
  kind: string;
  text: string;
}

/** An object of the road's file: length, width and height in m, 0 where it does not tell. */
export interface StandingObject {
  place: [number, number, number];
  heading: number;
  kind: string;
  size: [number, number, number];
}

export type RoadKind = "motorway" | "town" | "rural";

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
  kind: RoadKind;
  markings: Marking[];
  signs: Sign[];
  objects: StandingObject[];
  host: { length: number; width: number; front: number; wheel: number };
  others: number;
  /** *mount* and *left* in m from the centre of gravity; *turn* and *angle* in rad */
  sensors: {
    name: string;
    title: string;
    mount: number;
    left: number;
    turn: number;
    reach: number;
    angle: number;
    returns: number;
  }[];
  instruments: { title: string; unit: string; items: string[]; hasTarget: boolean }[];
  columns: Entry[];
  live?: LiveScene;
}

/** Each column is a constant and a sum of signals of a system that the page can simulate. */
export interface LiveScene {
  document: Document;
  sums: Record<string, [constant: number, ...parts: [signal: number, factor: number][]]>;
  signals: string[];
}

export interface Source {
  document: Document;
  /** Changes when there is more to see than before. */
  version: number;
  /** The first and the last moment there is, in s. */
  span(): [number, number];
  /** A column's value at a moment, straight between two frames. */
  at(name: string, time: number): number;
  /** The same for an angle, the short way round. */
  angle(name: string, time: number): number;
  /** The last frame's value: for numbers that stand for something. */
  held(name: string, time: number): number;
  /** Whether there is such a column. */
  has(name: string): boolean;
  /** The way the host's wheels have rolled, in m. */
  rolled(time: number): number;
  /** Every frame of a column there is. */
  each(name: string, use: (time: number, value: number) => void): void;
}

export interface Recording extends Source {
  seconds: number;
  /** Has these columns from now on. */
  become(columns: ReadonlyMap<string, ArrayLike<number>>): void;
}

/** From `start` to `end`, `share` of the way; for angles the short way round. */
export function between(start: number, end: number, share: number, isAngle: boolean): number {
  let change = end - start;
  if (isAngle) change -= 2 * Math.PI * Math.round(change / (2 * Math.PI));
  return start + share * change;
}

/** What dse/report/scene/html.py wrote: a document and columns over time. */
export async function readRecording(): Promise<Recording> {
  const text = (id: string): string => document.getElementById(id)!.textContent!;
  const read = JSON.parse(text("document")) as Document;
  const columns = await unpack(read.columns, text("columns"));
  // One that can be driven on has room for all that may come to be seen.
  return recordingOf(
    read.live ? { ...read.live.document, steps: read.steps, step: read.step, live: read.live } : read,
    columns,
  );
}

function recordingOf(read: Document, first: ReadonlyMap<string, ArrayLike<number>>): Recording {
  let columns = first;
  const last = read.steps - 1;
  const step = read.step || 1;
  const at = (name: string, time: number, isAngle: boolean): number => {
    const values = columns.get(name);
    if (!values) return 0;
    const exact = Math.min(Math.max(time / step, 0), last);
    const frame = Math.min(Math.floor(exact), Math.max(last - 1, 0));
    return between(values[frame]!, values[frame + 1] ?? values[frame]!, exact - frame, isAngle);
  };
  const sums = new Float64Array(read.steps);
  const roll = (): void => {
    const speed = columns.get("host.speed");
    for (let i = 1; i < read.steps; i++)
      sums[i] = sums[i - 1]! + (step * ((speed?.[i - 1] ?? 0) + (speed?.[i] ?? 0))) / 2;
  };
  roll();
  return {
    document: read,
    version: 0,
    seconds: last * step,
    become(others) {
      columns = others;
      this.version++;
      roll();
    },
    span: () => [0, last * step],
    has: (name) => columns.has(name),
    at: (name, time) => at(name, time, false),
    angle: (name, time) => at(name, time, true),
    held: (name, time) => columns.get(name)?.[Math.min(Math.max(Math.floor(time / step + 1e-6), 0), last)] ?? 0,
    rolled: (time) => {
      const frame = Math.min(Math.max(Math.floor(time / step), 0), last);
      return sums[frame]! + (columns.get("host.speed")?.[frame] ?? 0) * (time - frame * step);
    },
    each: (name, use) => {
      const values = columns.get(name);
      for (let frame = 0; values && frame < values.length; frame++) use(frame * step, values[frame]!);
    },
  };
}
