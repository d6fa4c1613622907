// Colours: named in the style sheet, read here for the canvases.
import type { Store } from "./store";

export interface Palette {
  ground: string;
  ink: string;
  muted: string;
  line: string;
  plot: string;
  feasible: string;
  veil: string;
  pass: string;
  broken: string;
  target: string;
  current: string;
  accent: string;
  requirements: string[];
  pins: string[];
  ramp: string[];
  font: string;
}

export function palette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const read = (name: string): string => style.getPropertyValue(`--${name}`).trim();
  const list = (name: string): string[] => read(name).split(/\s+/);
  return {
    ground: read("ground"),
    ink: read("ink"),
    muted: read("muted"),
    line: read("line"),
    plot: read("plot"),
    feasible: read("feasible"),
    veil: read("veil"),
    pass: read("pass"),
    broken: read("broken"),
    target: read("target"),
    current: read("current"),
    accent: read("accent"),
    requirements: list("requirements"),
    pins: list("pins"),
    ramp: list("ramp"),
    font: getComputedStyle(document.body).fontFamily,
  };
}

export function startTheme(): "light" | "dark" {
  const theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  document.documentElement.dataset.theme = theme;
  return theme;
}

/** Applies the chosen theme before anything is drawn, and follows the system until the reader chooses. */
export function followTheme(store: Store): { toggle: () => void } {
  let chosen = false;
  const media = matchMedia("(prefers-color-scheme: dark)");
  const apply = (theme: "light" | "dark"): void => {
    document.documentElement.dataset.theme = theme;
    store.set({ theme });
  };
  media.addEventListener("change", () => {
    if (!chosen) apply(media.matches ? "dark" : "light");
  });
  // Paper is white: what is printed is the light page.
  let shown: "light" | "dark" = store.state.theme;
  window.addEventListener("beforeprint", () => {
    shown = store.state.theme;
    apply("light");
    store.flush();
  });
  window.addEventListener("afterprint", () => apply(shown));
  return {
    toggle: () => {
      chosen = true;
      apply(store.state.theme === "dark" ? "light" : "dark");
    },
  };
}

/** `share` from 0 to 1 along the ramp, by straight lines between its colours. */
export function shade(ramp: string[], share: number): string {
  const place = Math.min(1, Math.max(0, share)) * (ramp.length - 1);
  const index = Math.min(ramp.length - 2, Math.floor(place));
  const [a, b] = [channels(ramp[index]!), channels(ramp[index + 1]!)];
  const mixed = a.map((value, i) => Math.round(value + (b[i]! - value) * (place - index)));
  return `rgb(${mixed.join(",")})`;
}

export function channels(hex: string): [number, number, number] {
  const value = parseInt(hex.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}
