// Who drives: keys, a gamepad, a steering wheel or fingers, as what the ports of the interface `driver` take.
import { wheelNow } from "./wheel";

export const FULL = 0.5; // rad at the wheels
const PRESS = 1.8; // 1/s
const RELEASE = 4;
const TURN = 0.9; // rad/s
const BACK = 1.6;
const DEAD = 0.08;
const HELD = 0.6; // s that a hand stays at the wheel
const FASTER = 5 / 3.6;
export const GAPS = ["fixed", "long", "middle", "short"];

/** Keys of which it is only told whether they are pressed. */
const PRESSED: Record<string, "accelerate" | "brake" | "left" | "right"> = {
  ArrowUp: "accelerate",
  KeyW: "accelerate",
  ArrowDown: "brake",
  KeyS: "brake",
  Space: "brake",
  Escape: "brake",
  ArrowLeft: "left",
  KeyA: "left",
  ArrowRight: "right",
  KeyD: "right",
};

export const KEYS: [string, string][] = [
  ["\u2191 or W", "accelerate"],
  ["\u2193, S, space or Esc", "brake; Esc brakes whatever else is pressed or open"],
  ["\u2190 \u2192 or A D", "steer"],
  ["C", "cruise control on, off"],
  ["+ \u2212", "set speed, in steps of 5 km/h"],
  ["G", "gap to the vehicle ahead"],
  ["1 2 3", "camera: chase, driver, top"],
  ["B", "horn"],
  ["M", "sound on, off"],
  ["H", "this help"],
  ["End", "finish the drive"],
];

/** A key event, and what stands in its way: a field that takes the key, the help that is open. */
export interface KeyPress extends Pick<KeyboardEvent, "type" | "code" | "ctrlKey" | "altKey" | "metaKey" | "repeat"> {
  isTaken: boolean;
  isHelp: boolean;
}

/** What keys do besides driving. */
export interface KeyActions {
  look(camera: number): void;
  help(): void;
  finish(): void;
}

/** Passes a key on to *controls* or *actions*; whether it meant something.
 *
 * A key that goes up always goes up, whatever is pressed or open: a pedal that stays down is the worst that can happen.
 * While Meta is down some systems do not tell which keys go up, so all do.
 */
export function press(controls: Controls, actions: KeyActions, key: KeyPress): boolean {
  const { type, code, isTaken, isHelp, repeat } = key;
  if (/^(Meta|OS)/.test(code)) controls.release();
  if (type !== "keydown") return controls.key(code, false);
  if (code === "Escape") {
    controls.key(code, true);
    return !isHelp; // which it closes as well
  }
  if (key.ctrlKey || key.altKey || key.metaKey || isHelp || isTaken) return false;
  if (repeat && !/^(Equal|Minus|Numpad|Slash|Bracket)/.test(code)) return /^(Arrow|Space)/.test(code);
  if (controls.key(code, true)) return true;
  const camera = /^Digit([1-3])$/.exec(code);
  if (camera) actions.look(Number(camera[1]) - 1);
  else if (code === "KeyH") {
    controls.release();
    actions.help();
  } else if (code === "End") actions.finish();
  return false;
}

export interface Fingers {
  accelerate: number;
  brake: number;
  /** From -1, to the right, to 1. */
  steer: number | null;
}

export class Controls {
  readonly fingers: Fingers = { accelerate: 0, brake: 0, steer: null };
  /** What the driver did last. */
  last: Record<string, number> = { accelerator: 0, brake: 0, steering: 0 };
  private readonly pressed = new Map<string, string>();
  private accelerator = 0;
  private braking = 0;
  private steering = 0;
  private hand = 0;
  private buttons: boolean[] = [];

  constructor(
    public cruise: boolean,
    public speed: number,
    public gap: number,
  ) {}

  /** Whether the key is one of those that drive. */
  key(code: string, isDown: boolean): boolean {
    if (code in PRESSED) {
      if (isDown) this.pressed.set(code, PRESSED[code]!);
      else this.pressed.delete(code);
      return true;
    }
    if (!isDown) return false;
    if (code === "KeyC") this.cruise = !this.cruise;
    else if (code === "KeyG") this.gap = (this.gap + 1) % GAPS.length;
    else if (code === "Equal" || code === "NumpadAdd" || code === "BracketRight") this.faster(1);
    else if (code === "Minus" || code === "NumpadSubtract" || code === "Slash") this.faster(-1);
    else return false;
    return true;
  }

  faster(steps: number): void {
    this.speed = Math.min(Math.max((Math.round(this.speed / FASTER) + steps) * FASTER, FASTER), 60);
  }

  /** Nobody holds a key in a window that is not looked at. */
  release(): void {
    this.pressed.clear();
    Object.assign(this.fingers, { accelerate: 0, brake: 0, steer: null });
  }

  /** What the driver does, *passed* s after it was asked last. */
  values(passed: number): Record<string, number> {
    const pad = this.pad();
    const does = (what: string): number => ([...this.pressed.values()].includes(what) ? 1 : 0);
    const ramp = (now: number, wanted: number, up: number, down: number): number =>
      wanted > now ? Math.min(wanted, now + up * passed) : Math.max(wanted, now - down * passed);
    this.accelerator = ramp(
      this.accelerator,
      Math.max(does("accelerate"), this.fingers.accelerate, pad.accelerate),
      PRESS,
      RELEASE,
    );
    this.braking = ramp(this.braking, Math.max(does("brake"), this.fingers.brake, pad.brake), 1.5 * PRESS, RELEASE);
    const direct = this.fingers.steer ?? pad.steer;
    const turned = does("left") - does("right");
    if (direct !== null) this.steering = direct * FULL;
    else if (turned)
      this.steering = ramp(
        this.steering,
        turned * FULL,
        this.steering < 0 ? BACK : TURN,
        this.steering > 0 ? BACK : TURN,
      );
    else this.steering = ramp(this.steering, 0, BACK, BACK);
    this.hand = direct !== null || turned ? HELD : Math.max(0, this.hand - passed);
    this.last = {
      accelerator: this.accelerator,
      brake: this.braking,
      steering: this.steering,
      hands_on: Number(this.hand > 0),
      cruise: Number(this.cruise),
      set_speed: this.speed,
      gap_setting: this.gap,
    };
    return this.last;
  }

  /** A wheel that was calibrated, else the first gamepad of the standard kind: triggers, left stick; A switches, B asks
   * for another gap, the bumpers for another speed. */
  private pad(): { accelerate: number; brake: number; steer: number | null } {
    const wheel = wheelNow();
    if (wheel) return wheel;
    const pad = navigator.getGamepads?.().find((each) => each?.mapping === "standard");
    if (!pad) return { accelerate: 0, brake: 0, steer: null };
    const tapped = (button: number): boolean => Boolean(pad.buttons[button]?.pressed) && !this.buttons[button];
    if (tapped(0)) this.cruise = !this.cruise;
    if (tapped(1)) this.gap = (this.gap + 1) % GAPS.length;
    if (tapped(4)) this.faster(-1);
    if (tapped(5)) this.faster(1);
    this.buttons = pad.buttons.map(({ pressed }) => pressed);
    const stick = -(pad.axes[0] ?? 0);
    const steer = Math.abs(stick) > DEAD ? (Math.sign(stick) * (Math.abs(stick) - DEAD)) / (1 - DEAD) : null;
    return { accelerate: pad.buttons[7]?.value ?? 0, brake: pad.buttons[6]?.value ?? 0, steer };
  }
}
