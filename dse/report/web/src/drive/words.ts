// What signals of a car mean to who drives it, in words of a dashboard.

type Level = "calm" | "active" | "alarm";

export interface Phrase {
  text: string;
  level: Level;
}

const calm = (text: string): Phrase => ({ text, level: "calm" });
const active = (text: string): Phrase => ({ text, level: "active" });
const alarm = (text: string): Phrase => ({ text, level: "alarm" });

/** By the items that a signal has: what it says to a driver, and what each item does. */
const MEANINGS: { items: string[]; title: string; phrases: Record<string, Phrase> }[] = [
  {
    items: ["manual", "standby", "cruise", "override", "emergency"],
    title: "Cruise control",
    phrases: {
      manual: calm("off"),
      standby: calm("ready \u2013 press C"),
      cruise: active("active"),
      override: calm("you accelerate"),
      emergency: alarm("EMERGENCY BRAKE"),
    },
  },
  {
    items: ["driver", "lane_keeping"],
    title: "Steering",
    phrases: { driver: calm("you steer"), lane_keeping: active("keeps the lane") },
  },
  {
    items: ["none", "warning", "partial", "full"],
    title: "Collision warning",
    phrases: {
      none: calm("clear"),
      warning: alarm("BRAKE NOW"),
      partial: alarm("BRAKING FOR YOU"),
      full: alarm("FULL BRAKING"),
    },
  },
  {
    items: ["wish", "limit", "curve", "light"],
    title: "Target speed from",
    phrases: {
      wish: calm("you"),
      limit: active("the speed limit"),
      curve: active("the bend ahead"),
      light: active("the traffic light"),
    },
  },
  {
    items: ["speed", "distance"],
    title: "Following",
    phrases: { speed: calm("free road"), distance: active("vehicle ahead") },
  },
];

/** What a signal with *items* is called on a dashboard, and what it says; null if it says nothing to a driver. */
export function meaningOf(items: string[]): { title: string; say(item: number): Phrase } | null {
  const known = MEANINGS.find((each) => each.items.join() === items.join());
  if (!known) return null;
  return { title: known.title, say: (item) => known.phrases[items[Math.round(item)] ?? ""] ?? calm("\u2013") };
}

const WRITTEN_OUT: Record<string, string> = {
  aeb: "emergency brake",
  cg: "centre of gravity",
  kd: "D gain",
  ki: "I gain",
  kp: "P gain",
  max: "maximum",
  min: "minimum",
  ttc: "time to collision",
};

/** The name of a part or parameter as words: `max_steering` is "Maximum steering". */
export function wordsOf(name: string): string {
  const words = name.split("_").map((word) => WRITTEN_OUT[word] ?? word);
  const text = words.join(" ");
  return `${text[0]?.toUpperCase() ?? ""}${text.slice(1)}`;
}

/** What a slider is called, the part that it belongs to, and what its component says of it ("" if nothing). */
export function labelOf(name: string, title: string): { part: string; label: string; note: string } {
  const path = name.split(".");
  const last = path.pop()!;
  return { part: path.map(wordsOf).join(" \u203a "), label: wordsOf(last), note: title === last ? "" : title };
}
