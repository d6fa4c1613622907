// Workers that simulate. What was asked for last goes first; what nobody waits for any more is dropped.
import type { SimulationDocument } from "./document";
import type { Point, Ran } from "./engine";
import type { Answer, Order } from "./worker";

/** Milliseconds of work that a worker is given at once: so long the newest point may have to wait. */
const PORTION = 12;

/** Milliseconds after which a worker that does not answer is ended. */
const PATIENCE = 20_000;

const MOST_WORKERS = 4;

interface Task {
  point: Point;
  tell: (ran: Ran) => void;
}

export interface Pool {
  /** Simulates this one before all others; the one that was asked for before it, if it still waits, is dropped. */
  now(point: Point, tell: (ran: Ran) => void): void;
  /** Simulates these in turn instead of those before them. */
  instead(points: Point[], tell: (ran: Ran, place: number) => void): void;
  /** Ends the workers. */
  close(): void;
}

export function createPool(script: string, document: SimulationDocument, module: WebAssembly.Module): Pool {
  const address = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
  let urgent: Task | null = null;
  let waiting: Task[] = [];
  let each = PORTION;
  const hands = Array.from({ length: Math.min(MOST_WORKERS, navigator.hardwareConcurrency || 1) }, () => hand());
  let isClosed = false;

  function hand() {
    let given: Task[] = [];
    let watch = 0;
    let worker = started();
    function started(): Worker {
      const made = new Worker(address);
      made.addEventListener("message", ({ data }: MessageEvent<Answer>) => {
        clearTimeout(watch);
        const done = given;
        given = [];
        each = Math.max(0.1, data.took / done.length);
        done.forEach(({ tell }, place) => tell(data.runs[place]!));
        feed();
      });
      made.addEventListener("error", (event) => {
        event.preventDefault();
        giveUp(`its worker ended: ${event.message || "this browser does not let a page simulate"}`);
      });
      made.postMessage({ document, module } satisfies Order);
      return made;
    }
    function giveUp(problem: string): void {
      clearTimeout(watch);
      worker.terminate();
      const lost = given;
      given = [];
      const nothing = { metrics: document.metrics.length, marks: document.requirements.length };
      for (const { tell } of lost)
        tell({
          problem,
          metrics: new Float64Array(nothing.metrics).fill(NaN),
          marks: new Uint8Array(nothing.marks),
          close: new Uint8Array(nothing.marks),
          traces: [],
          columns: {},
        });
      if (isClosed) return;
      worker = started();
      feed();
    }
    return {
      isIdle: () => !given.length,
      give(tasks: Task[]): void {
        given = tasks;
        watch = window.setTimeout(() => giveUp(`it did not end within ${PATIENCE / 1000} s`), PATIENCE);
        worker.postMessage({ points: tasks.map(({ point }) => point) } satisfies Order);
      },
      close: (): void => {
        clearTimeout(watch);
        worker.terminate();
      },
    };
  }

  function feed(): void {
    for (const one of hands) {
      if (!one.isIdle()) continue;
      const tasks = urgent ? [urgent] : waiting.splice(0, Math.max(1, Math.floor(PORTION / each)));
      urgent = null;
      if (tasks.length) one.give(tasks);
    }
  }

  return {
    now(point, tell) {
      urgent = { point, tell };
      feed();
    },
    instead(points, tell) {
      const tasks: Task[] = points.map((point, place) => ({
        point,
        // Of what was cancelled while it was simulated nobody wants to hear.
        tell: (ran) => waiting === tasks && tell(ran, place),
      }));
      waiting = tasks;
      feed();
    },
    close() {
      isClosed = true;
      for (const one of hands) one.close();
      URL.revokeObjectURL(address);
    },
  };
}
