// A run that is being driven, as its frames come: shown a little late, so that what moves moves evenly between them.
import { between, type Document, type Source } from "./data";

const KEPT = 20; // s that instruments look back
const JUMP = 0.5; // s
const PULL = 0.05;

export interface Stream extends Source {
  add(time: number, values: Float64Array): void;
  /** The moment to be shown when the page's clock says *now* (ms). */
  moment(now: number): number;
  /** The newest value of a column. */
  newest(name: string): number;
}

export function openStream(document: Document, columns: string[], rate: number): Stream {
  const places = new Map(columns.map((name, place) => [name, place]));
  const most = Math.ceil(KEPT * rate);
  const speed = places.get("host.speed");
  let times: number[] = [];
  let frames: Float64Array[] = [];
  let ways: number[] = [];
  let ahead = NaN; // of the page's clock, in s
  let shown = -Infinity;

  // Asked for the same moments again and again, and always for the newest.
  const frameOf = (time: number): number => {
    let frame = times.length - 1;
    while (frame > 0 && times[frame]! > time + 1e-9) frame--;
    return frame;
  };
  const at = (name: string, time: number, isAngle: boolean): number => {
    const place = places.get(name);
    if (place === undefined || !frames.length) return 0;
    const frame = frameOf(time);
    const start = frames[frame]![place]!;
    const next = frames[frame + 1];
    if (!next || time <= times[frame]!) return start;
    return between(start, next[place]!, (time - times[frame]!) / (times[frame + 1]! - times[frame]!), isAngle);
  };
  const stream: Stream = {
    document,
    version: 0,
    add: (time, values) => {
      const last = times.length - 1;
      if (last >= 0 && time <= times[last]!) return;
      const way = last < 0 || speed === undefined ? 0 : ways[last]! + (time - times[last]!) * values[speed]!;
      times.push(time);
      frames.push(values);
      ways.push(way);
      if (times.length > 2 * most) [times, frames, ways] = [times.slice(-most), frames.slice(-most), ways.slice(-most)];
      stream.version++;
    },
    // The clock of the run is followed slowly: frames that come unevenly must not be seen to.
    moment: (now) => {
      if (!times.length) return 0;
      const newest = times.at(-1)!;
      const wanted = newest - 1.2 / rate;
      const error = wanted - (now / 1000 + ahead);
      ahead = Number.isFinite(error) && Math.abs(error) < JUMP ? ahead + PULL * error : wanted - now / 1000;
      shown = Math.max(shown, Math.min(now / 1000 + ahead, newest));
      return shown;
    },
    newest: (name) => frames.at(-1)?.[places.get(name) ?? -1] ?? NaN,
    span: () => [Math.max(times[0] ?? 0, (times.at(-1) ?? 0) - KEPT), times.at(-1) ?? 0],
    has: (name) => places.has(name),
    at: (name, time) => at(name, time, false),
    angle: (name, time) => at(name, time, true),
    held: (name, time) => frames[frameOf(time)]?.[places.get(name) ?? -1] ?? 0,
    rolled: (time) => {
      const frame = frameOf(time);
      return frame < 0 ? 0 : ways[frame]! + (time - times[frame]!) * (speed === undefined ? 0 : frames[frame]![speed]!);
    },
    each: (name, use) => {
      const place = places.get(name);
      if (place !== undefined) frames.forEach((values, frame) => use(times[frame]!, values[place]!));
    },
  };
  return stream;
}
