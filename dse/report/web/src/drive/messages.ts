// What the page and the server say to each other.
import type { Document } from "../scene/data";
import { openStream, type Stream } from "../scene/stream";
import type { World } from "./world";

export interface Alternative {
  name: string;
  title: string;
  is_possible: boolean;
  because: string[];
  rules_out: { path: string; name: string }[];
  /** Places whose choice, given up alone, would make it possible. */
  change: string[];
  /** What it adds by itself to the price and the mass. */
  adds: { name: string; unit: string; value: number }[];
}

export interface Point {
  path: string;
  title: string;
  chosen: string | null;
  implied: string | null;
  alternatives: Alternative[];
}

export interface Offer {
  title: string;
  chosen: Record<string, string>;
  total: string;
  left: string;
  configuration: string | null;
  conflict: string[];
  points: Point[];
  totals: { name: string; title: string; unit: string; low: number; high: number }[];
}

export interface Tunable {
  name: string;
  title: string;
  unit: string;
  min: number;
  max: number;
  value: number;
}

export interface Ended {
  why: "finished" | "crashed" | "limit" | "lost";
  text: string;
  drive: string | null;
  verdicts: { title: string; verdict: string; margin?: number | null }[];
}

export interface Drive {
  stream: Stream;
  tunables: Tunable[];
  controls: string[];
  /** What the controls are at first. */
  first: Record<string, number>;
  /** Its number in a shared world, and who drives if this page only watches. */
  seat?: number | undefined;
  watched?: string | undefined;
  /** What to do with news of that world. */
  news: (world: World) => void;
  /** What the last frame told besides its columns. */
  pace: { lateness: number; overruns: number; echoes: number[] };
  send(kind: "control" | "tune", values: Record<string, number>): void;
  finish(): void;
  leave(): void;
}

const AHEAD = 4; // numbers of a frame before its columns
const KEPT = 500;

/** What the server answers; an Error in its words if it refuses. */
export async function ask<T>(path: string, body?: object, signal?: AbortSignal): Promise<T> {
  const asked = body && { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) };
  let answer: Response;
  try {
    answer = await fetch(path, { ...asked, signal: signal ?? null });
  } catch {
    signal?.throwIfAborted();
    throw new Error("the server cannot be reached");
  }
  const text = await answer.text();
  if (answer.ok) return JSON.parse(text) as T;
  throw new Error(problemIn(text) || `the server answered ${answer.status}`);
}

function problemIn(text: string): string {
  try {
    const { problems, error } = JSON.parse(text) as { problems?: { what: string; hint?: string }[]; error?: string };
    return problems?.map(({ what, hint }) => [what, hint].filter(Boolean).join(" \u2013 ")).join("; ") ?? error ?? "";
  } catch {
    return text.trim().slice(0, 300);
  }
}

export function offerAddress(bench: string, chosen: Record<string, string>): string {
  return `/drive/offer?${new URLSearchParams({ bench, chosen: written(chosen) })}`;
}

export function written(chosen: Record<string, string>): string {
  return Object.entries(chosen)
    .map(([path, name]) => `${path}:${name}`)
    .join(",");
}

export function readChoices(text: string): Record<string, string> {
  const pairs = text.split(",").map((each) => each.split(":"));
  return Object.fromEntries(pairs.filter((pair) => pair.length === 2 && pair[0] && pair[1]) as [string, string][]);
}

/** Resolves when there is something to see; `over` is called once, whatever ends the drive. */
export function connect(
  asked: { drive: string } | { watch: string },
  over: (ended: Ended) => void,
  signal?: AbortSignal,
): Promise<Drive> {
  return new Promise((resolve, reject) => {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/drive/live?${new URLSearchParams(asked)}`);
    socket.binaryType = "arraybuffer";
    let drive: Drive | null = null;
    let isOver = false;
    const end = (ended: Ended): void => {
      if (isOver) return;
      isOver = true;
      if (drive) over(ended);
      else reject(new Error(ended.text));
      socket.close();
    };
    signal?.addEventListener("abort", () => {
      if (!drive) end({ why: "lost", text: "The drive was cancelled", drive: null, verdicts: [] });
    });
    socket.onclose = () =>
      end({ why: "lost", text: "The connection to the drive was lost", drive: null, verdicts: [] });
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (typeof data !== "string") {
        if (drive) take(drive, data);
        return;
      }
      const told = JSON.parse(data) as { type: string };
      if (told.type === "scene") {
        drive = begun(socket, told as unknown as Scene);
        resolve(drive);
      } else if (told.type === "world") drive?.news(told as unknown as World);
      else if (told.type === "ended") end(told as unknown as Ended);
    };
  });
}

interface Scene {
  document: Document;
  columns: string[];
  rate: number;
  tunables: Tunable[];
  controls: string[];
  start: Record<string, number>;
  seat?: number;
  watched?: string;
}

const sent = new WeakMap<Drive, Map<number, number>>();

function begun(socket: WebSocket, scene: Scene): Drive {
  const { document, columns, rate, tunables, controls, start, seat, watched } = scene;
  let number = 0;
  const times = new Map<number, number>();
  const drive: Drive = {
    stream: openStream({ ...document, step: 1 / rate }, columns, rate),
    tunables,
    controls,
    first: start,
    seat,
    watched,
    news: () => undefined,
    pace: { lateness: 0, overruns: 0, echoes: [] },
    send: (type, values) => {
      if (socket.readyState !== WebSocket.OPEN || watched !== undefined) return;
      // While a drive begins nothing answers.
      if (drive.stream.version) times.set(++number, performance.now());
      else number++;
      socket.send(JSON.stringify({ type, n: number, values }));
    },
    finish: () => {
      if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ type: "finish" }));
    },
    leave: () => socket.close(),
  };
  sent.set(drive, times);
  return drive;
}

function take(drive: Drive, data: ArrayBuffer): void {
  const numbers = new Float64Array(data);
  const [time, lateness, overruns, echo] = numbers;
  drive.pace.lateness = lateness!;
  drive.pace.overruns = overruns!;
  const times = sent.get(drive)!;
  for (const [number, when] of times) {
    if (number > echo!) continue;
    if (number === echo) drive.pace.echoes = [...drive.pace.echoes.slice(-KEPT), performance.now() - when];
    times.delete(number);
  }
  drive.stream.add(time!, numbers.subarray(AHEAD));
}
