// Steering wheels with pedals: browsers do not tell which axis is which, so the driver shows it once.
import { el } from "../dom";

/** An axis that goes from *low*, where nothing is done, to *high*. */
export interface Range {
  axis: number;
  low: number;
  high: number;
}

/** For the wheel `low` is fully left and `high` fully right. */
export interface Calibration {
  steer: Range;
  accelerate: Range;
  brake: Range;
}

type Pad = Pick<Gamepad, "id" | "axes" | "mapping">;

const STORED = "dse.wheel";
const LEAST = 0.25; // of the way of an axis that counts as meant
const DEAD = 0.02;

/** The axis that moved most between *rest* and *moved*; null if none did. */
export function movedAxis(
  rest: readonly number[],
  moved: readonly number[],
  not: readonly number[] = [],
): Range | null {
  let found: Range | null = null;
  moved.forEach((high, axis) => {
    const low = rest[axis] ?? 0;
    const isMore = !found || Math.abs(high - low) > Math.abs(found.high - found.low);
    if (!not.includes(axis) && Math.abs(high - low) > LEAST && isMore) found = { axis, low, high };
  });
  return found;
}

/** Where an axis is between its ends, from 0 to 1. */
export function shareOf({ axis, low, high }: Range, axes: readonly number[]): number {
  const share = ((axes[axis] ?? low) - low) / (high - low || 1);
  return Math.min(Math.max(share, 0), 1);
}

/** What a wheel says; `steer` > 0 to the left. */
export function readWheel(
  calibration: Calibration,
  axes: readonly number[],
): { accelerate: number; brake: number; steer: number | null } {
  const steer = 1 - 2 * shareOf(calibration.steer, axes);
  const pressed = (range: Range): number => {
    const share = shareOf(range, axes);
    return share < DEAD ? 0 : share;
  };
  return {
    accelerate: pressed(calibration.accelerate),
    brake: pressed(calibration.brake),
    steer: Math.abs(steer) > DEAD ? steer : null,
  };
}

/** Axes that have moved, by wheel: until then browsers report 0 for them, which is a pedal that is half pressed. */
const moved = new Map<string, Set<number>>();

/** The wheel that was calibrated, if it is plugged in. */
export function wheelNow(): ReturnType<typeof readWheel> | null {
  const pad = navigator.getGamepads?.().find((each): each is Gamepad => Boolean(each && stored()[each.id]));
  if (!pad) {
    moved.clear();
    return null;
  }
  const calibration = stored()[pad.id]!;
  const own = moved.get(pad.id) ?? new Set();
  moved.set(pad.id, own);
  pad.axes.forEach((value, axis) => {
    if (value !== 0) own.add(axis);
  });
  const resting = [calibration.accelerate, calibration.brake].filter(({ axis }) => !own.has(axis));
  const axes = [...pad.axes];
  for (const { axis, low } of resting) axes[axis] = low;
  return readWheel(calibration, axes);
}

let known: Record<string, Calibration> | null = null;

function stored(): Record<string, Calibration> {
  try {
    known ??= JSON.parse(globalThis.localStorage?.getItem(STORED) ?? "{}") as Record<string, Calibration>;
  } catch {
    known = {};
  }
  return known;
}

function keep(id: string, calibration: Calibration): void {
  known = { ...stored(), [id]: calibration };
  try {
    localStorage.setItem(STORED, JSON.stringify(known));
  } catch {
    // It counts until the page is closed.
  }
}

const STEPS = [
  ["left", "Turn the wheel fully to the left and press Next."],
  ["right", "Turn it fully to the right and press Next."],
  ["accelerate", "Let the wheel go, press the accelerator fully and press Next."],
  ["brake", "Release it, press the brake fully and press Next."],
  // Last: before a pedal has moved, browsers do not know where it rests.
  ["rest", "Release both pedals and press Next."],
] as const;

/** Asks for one movement after another; calls *done* at the end. */
export function buildCalibration(done: () => void): HTMLElement {
  const text = el("p", { role: "status" }, "Plug the wheel in, turn it a little, and press Start.");
  const button = el("button", { type: "button", click: () => next() }, "Start");
  const seen: Partial<Record<(typeof STEPS)[number][0], readonly number[]>> = {};
  let step = -1;
  const padNow = (): Pad | null =>
    navigator.getGamepads?.().find((pad) => pad && pad.mapping !== "standard" && pad.axes.length > 1) ?? null;
  const next = (): void => {
    const pad = padNow();
    if (!pad) {
      text.textContent = "No steering wheel is found. Plug it in, move it, and press Start.";
      return;
    }
    if (step >= 0) seen[STEPS[step]![0]] = [...pad.axes];
    step++;
    if (step < STEPS.length) {
      text.textContent = STEPS[step]![1];
      button.textContent = "Next";
      return;
    }
    const found = calibrationOf(seen.rest!, seen.left!, seen.right!, seen.accelerate!, seen.brake!);
    if (typeof found === "string") text.textContent = `${found} Press Start to try again.`;
    else {
      keep(pad.id, found);
      text.textContent = `${pad.id} is calibrated.`;
      done();
    }
    step = -1;
    button.textContent = "Start";
  };
  return el(
    "section",
    { class: "calibration", "aria-label": "Steering wheel" },
    el("h3", {}, "Steering wheel"),
    text,
    button,
  );
}

/** From what the axes were in each position; words if one did not move. */
export function calibrationOf(
  rest: readonly number[],
  left: readonly number[],
  right: readonly number[],
  accelerate: readonly number[],
  brake: readonly number[],
): Calibration | string {
  const steer = movedAxis(left, right);
  if (!steer) return "The wheel did not move.";
  const pedals = [steer.axis];
  const first = movedAxis(rest, accelerate, pedals);
  if (!first) return "The accelerator did not move.";
  const second = movedAxis(rest, brake, pedals);
  if (!second) return "The brake did not move.";
  if (first.axis === second.axis && Math.sign(first.high - first.low) === Math.sign(second.high - second.low))
    return "Accelerator and brake moved the same axis the same way.";
  return { steer, accelerate: first, brake: second };
}
