// The worker of a page that simulates: it is given the module first, then points, which it answers one by one.
import type { SimulationDocument } from "./document";
import { Engine, type Point, type Ran } from "./engine";

export type Order = { document: SimulationDocument; module: WebAssembly.Module } | { points: Point[] };

/** The runs of one order, and the milliseconds they took. */
export interface Answer {
  runs: Ran[];
  took: number;
}

let engine: Engine;

addEventListener("message", ({ data }: MessageEvent<Order>) => {
  if ("module" in data) {
    engine = new Engine(data.document, data.module);
    return;
  }
  const started = performance.now();
  const runs = data.points.map((point) => engine.run(point));
  (postMessage as (answer: Answer) => void)({ runs, took: performance.now() - started });
});
